"""Branches of a linkage's inverse may have names of the spec's, in the order of their own."""

from pathlib import Path

from linkages.hydraulic import spec
from walkgen.model.assemble import assemble
from walkgen.model.classify import inverse_class
from walkgen.spec.read import read

YAWED = (Path(__file__).parents[2] / "specs" / "hydraulic_leg.toml").read_text(encoding="utf-8")


def names(folder, text):
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    mechanism = assemble(read(path), folder)
    return inverse_class(mechanism, mechanism.legs[0]).branch_names


def test_names_stand_for_the_branches_in_their_order(tmp_path):
    assert names(tmp_path, YAWED) == ("yaw_plus_h_left", "yaw_plus_h_right", "yaw_minus_h_left", "yaw_minus_h_right")
    own = 'branches = ["ahead_up", "ahead_down", "back_up", "back_down"]'
    assert names(tmp_path, YAWED.replace('foot = "shank.P"', f'foot = "shank.P"\n{own}')) == (
        "ahead_up",
        "ahead_down",
        "back_up",
        "back_down",
    )
    short = spec().replace('foot = "shank.P"', 'foot = "shank.P"\nbranches = ["up", "down"]')
    assert names(tmp_path, short) == ("up", "down")


def test_a_short_form_has_branches_too(tmp_path):
    minitaur = (Path(__file__).parents[2] / "specs" / "minitaur.toml").read_text(encoding="utf-8")
    found = names(tmp_path, minitaur)
    assert len(found) == 4
    renamed = tuple(f"way_{number}" for number in range(4))
    quoted = ", ".join(f'"{name}"' for name in renamed)
    head, table, tail = minitaur.partition("[leg_designs.")
    design, line, rest = tail.partition("\n")
    assert names(tmp_path, f"{head}{table}{design}{line}branches = [{quoted}]\n{rest}") == renamed
