"""What equal legs get from one derivation is what each would get from its own."""

from dataclasses import replace
from pathlib import Path

import pytest

from walkgen.pipeline import mechanism_of
from walkgen.symbolic import likeness
from walkgen.symbolic.derive import derive

SPECS = Path(__file__).parents[2] / "specs"
NAMES = ("foot_position", "inverse_near", "inverse_velocity", "inverse_distance", "inverse_dynamics", "reactions")


@pytest.mark.parametrize("spec", ["mero_leg", "hydraulic_leg"])
def test_a_leg_derived_from_its_equal_is_the_leg_derived_alone(spec, monkeypatch):
    mechanism = mechanism_of(SPECS / f"{spec}.toml")
    leg = mechanism.legs[0]
    mechanism = replace(mechanism, platforms=(*mechanism.platforms, mechanism.platforms[0]))
    other = replace(leg, name="other", platform=len(mechanism.platforms) - 1)
    alone = tuple(derive(replace(mechanism, legs=(other,)), NAMES))
    assert any(function.signature.owner == "other" for function in alone)

    derived = []
    monkeypatch.setattr(likeness, "_owned", lambda function, owner, owned=likeness._owned: derived.append(owner) or owned(function, owner))
    both = tuple(derive(replace(mechanism, legs=(leg, other)), NAMES))
    assert len(derived) == len(alone)
    assert both[len(alone) :] == alone


def _turned(leg):
    return replace(leg, name="other", senses=tuple(-sense for sense in leg.senses or (1,) * len(leg.joints)))


def _renamed(leg):
    return replace(leg, name="other")


@pytest.mark.parametrize(("spec", "changed"), [("mero_leg", _turned), ("anthropomorphic_leg", _renamed)])
def test_a_leg_that_differs_or_has_unknowns_of_its_name_is_derived_for_itself(spec, changed, monkeypatch):
    mechanism = mechanism_of(SPECS / f"{spec}.toml")
    leg = mechanism.legs[0]
    other = changed(leg)
    monkeypatch.setattr(likeness, "_owned", lambda *_: pytest.fail("taken from another leg"))
    assert len(tuple(derive(replace(mechanism, legs=(leg, other)), NAMES))) > 0
