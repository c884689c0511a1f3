"""Breaks one thing of the example spec; `@@` in a replacement marks where the problem must be reported."""

from dataclasses import dataclass
from pathlib import Path

EXAMPLE = (Path(__file__).parent / "data" / "example_spec.toml").read_text(encoding="utf-8")
MARK = "@@"


@dataclass(frozen=True)
class Bad:
    """Replace `old` (its first occurrence) by `new`: the problem `code` stands at the mark, and its text holds `says`."""

    name: str
    code: str
    old: str
    new: str
    says: str = ""

    @property
    def marked(self) -> str:
        assert self.old in EXAMPLE, self.old
        return EXAMPLE.replace(self.old, self.new, 1)

    @property
    def text(self) -> str:
        return self.marked.replace(MARK, "")

    @property
    def place(self) -> tuple[int, int]:
        before = self.marked[: self.marked.index(MARK)]
        return before.count("\n") + 1, len(before) - before.rfind("\n")


THIGH = '[[leg_designs.mero_leg.joints]]\nname = "thigh"\ntype = "revolute"\na = "thigh"\nalpha_deg = 0\n'
ROBOT = EXAMPLE.partition("[robot]\n")[2].partition("\n\n")[0]
DESIGN = '[leg_designs.mero_leg]\ndh = "classic"'
LEVEL = 'end = "level"' + EXAMPLE.partition('end = "level"')[2].partition("\n")[0] + "\n"
MIRROR = 'mirror_of = "front_left"'
LINK = "link = { mass = 1.2, com = [0.0, 0.0, 0.0], inertia = [0.002, 0.002, 0.002, 0.0, 0.0, 0.0] }"
MIDDLE = '[[platforms]]\nname = "middle"\nparent = "front"\nchain = "waist"'
REAR = '[[platforms]]\nname = "rear"\nparent = "{parent}"\nchain = "waist"\n\n'

ONE = (
    Bad("misspelt key", "WG110", "alpha_deg = 90", "@@alfa_deg = 90", 'did you mean "alpha_deg"?'),
    Bad("unknown key", "WG110", 'name = "front"', 'name = "front"\n@@colour = 3', "allowed here: name, parent"),
    Bad("unknown key in an inline table", "WG110", "mount = { xyz", "mount = { @@xyy = 1, xyz", 'did you mean "xyz"?'),
    Bad("unknown table", "WG110", "[generate]", "[@@generat]", 'did you mean "generate"?'),
    Bad("no name", "WG111", "[robot]\n", "[@@robot]\n#", 'missing key "name"'),
    Bad("no gravity", "WG111", "[robot]\n" + ROBOT, "[@@robot]\n" + ROBOT.replace("gravity", "# gravity"), "9.80665"),
    Bad("no joint type", "WG111", 'joints = [\n  { name = "yaw",   type = "revolute",', 'joints = [\n  @@{ name = "yaw",', "type"),
    Bad("no twist", "WG111", THIGH, THIGH.replace("joints]]", "@@joints]]").replace("alpha_deg = 0\n", ""), 'missing key "alpha"'),
    Bad(
        "no axis",
        "WG111",
        '  { name = "yaw",   type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0 }',
        '  @@{ name = "yaw", type = "revolute", xyz = [0, 0, 1] }',
        "axis",
    ),
    Bad("leg without design", "WG111", '[[legs]]\nname = "front_left"\ndesign = "mero_leg"', '[[@@legs]]\nname = "front_left"', '"design"'),
    Bad("text for a list", "WG112", "com = [0.0, 0.0, 0.0], inertia", '@@com = "here", inertia', 'the text "here"'),
    Bad("two of three", "WG112", "end_xyz = [-0.30, 0.0, 0.0]", "@@end_xyz = [-0.30, 0.0]", "2 entries"),
    Bad("three of two", "WG112", "limits_deg = [-60, 60]", "@@limits_deg = [-60, 0, 60]", "3 entries; 2"),
    Bad("truth for a number", "WG112", "a = 0.0", "@@a = true", "number"),
    Bad("number for truth", "WG112", "derivatives = false", "@@derivatives = 0", "true or false"),
    Bad("number for a text", "WG112", 'name = "front"', "@@name = 5", "a text in quotes"),
    Bad("list for a table", "WG112", "mount = { xyz = [0.0, 0.20, 0.0], rpy_deg = [0, 0, 90] }", "@@mount = [0, 0]", "a list of 2"),
    Bad("date", "WG112", "d = 0.0", "@@d = 2020-01-01", "number"),
    Bad("nan", "WG113", "mass = 12.0", "@@mass = nan", "finite"),
    Bad("infinite entry", "WG113", "gravity = [0.0, 0.0, -9.80665]", "gravity = [0.0, 0.0, @@-inf]", "finite"),
    Bad("too large", "WG113", "E = 70e9", "@@E = 70e999", "double"),
    Bad("too large a whole number", "WG113", "E = 70e9", f"@@E = {'9' * 400}", "double"),
    Bad("no arithmetic", "WG114", '\na = "thigh"', """\n@@a = "__import__('os')" """, "not allowed"),
    Bad("unknown function", "WG114", '\na = "thigh"', '\n@@a = "max(thigh, 1)"', "hypot"),
    Bad("braces in an expression", "WG114", '\na = "thigh"', '\n@@a = "{thigh}"', "{thigh}"),
    Bad("another version", "WG115", "walkgen = 1", "@@walkgen = 2", "version 1"),
    Bad("unknown type of joint", "WG116", 'type = "revolute"', '@@type = "revolut"', 'did you mean "revolute"?'),
    Bad("unknown convention", "WG116", 'dh = "classic"', '@@dh = "modified"', "craig"),
    Bad("unknown target", "WG116", '"casadi", "numpy"]', '@@"cassadi", "numpy"]', 'did you mean "casadi"?'),
    Bad("sign", "WG116", 'dh = "classic"', 'dh = "classic"\nsigns = [1, @@0, 1]', "1, -1"),
    Bad("unknown end", "WG116", 'end = "level"', '@@end = "levle"', 'did you mean "level"?'),
    Bad("no convention", "WG120", '[leg_designs.mero_leg]\ndh = "classic"', "[leg_designs.@@mero_leg]", "craig"),
    Bad("degrees without unit", "WG121", "alpha_deg = 90", "@@alpha = 90", "write alpha_deg = 90"),
    Bad("degrees in a pose", "WG121", "rpy_deg = [0, 0, 90] }", "@@rpy = [0, 0, 90] }", "rpy_deg = [0, 0, 90]"),
    Bad("degrees in limits", "WG121", "limits_deg = [-60, 60]", "@@limits = [-60, 60]", "limits_deg"),
    Bad("degrees in zeros", "WG121", 'dh = "classic"', 'dh = "classic"\nzeros = [0, @@90, 0]', "zeros_deg"),
    Bad("two units", "WG122", "alpha_deg = 90", "alpha = 1.5\n@@alpha_deg = 90", "alpha"),
    Bad("angles of a slide", "WG123", "limits_deg = [-90, 90]", "@@limits_mm = [-90, 90]", "revolute"),
    Bad("row and origin", "WG124", "a = 0.0", "a = 0.0\n@@xyz = [0, 0, 0]", "origin"),
    Bad(
        "offset without level",
        "WG124",
        LEVEL,
        "@@",
        "level",
    ),
    Bad("two signs for three joints", "WG125", 'dh = "classic"', 'dh = "classic"\n@@signs = [1, -1]', "3 joints"),
    Bad("source names", "WG125", 'chain = "waist"', 'chain = "waist"\n@@source_names = ["A"]', "3 joints"),
    Bad(
        "joint without geometry",
        "WG126",
        '  { name = "yaw",   type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0 }',
        '  @@{ name = "yaw", type = "revolute" }',
        "DH row",
    ),
    Bad("three names of four branches", "WG127", DESIGN, f'{DESIGN}\n@@branches = ["a", "b", "c"]', "give 4 names"),
    Bad("a name of no branch", "WG130", DESIGN, f'{DESIGN}\nbranches = ["a", "b", @@"Knee up", "c"]', "not a name"),
    Bad("two branches of a name", "WG132", DESIGN, f'{DESIGN}\nbranches = ["a", "b", "c", @@"a"]', "twice"),
    Bad("branches that are no list", "WG112", DESIGN, f'{DESIGN}\n@@branches = "a"', '"a"'),
    Bad("sole without width", "WG111", DESIGN, f"{DESIGN}\n@@sole = {{ length = 0.2 }}", "write width = 0.1"),
    Bad("sole without length", "WG111", DESIGN, f"{DESIGN}\n@@sole = {{ width_mm = 90 }}", "write length = 0.1"),
    Bad("sole of no width", "WG161", DESIGN, f"{DESIGN}\nsole = {{ length = 0.2, @@width = 0 }}", "more than 0"),
    Bad("sole of negative length", "WG161", DESIGN, f"{DESIGN}\nsole = {{ @@length_mm = -200, width = 0.1 }}", "more than 0"),
    Bad("pad of no stiffness", "WG161", DESIGN, f"{DESIGN}\nsole = {{ length = 0.2, width = 0.1, @@kn = 0.0 }}", "leave the key out"),
    Bad("sole in two units", "WG122", DESIGN, f"{DESIGN}\nsole = {{ length = 0.2, @@length_mm = 200, width = 0.1 }}", "length"),
    Bad("sole in degrees", "WG121", DESIGN, f"{DESIGN}\nsole = {{ length = 0.2, width = 0.1, @@rpy = [0, -90, 0] }}", "rpy_deg"),
    Bad("misspelt key of a sole", "WG110", DESIGN, f"{DESIGN}\nsole = {{ length = 0.2, width = 0.1, @@lenght = 1 }}", '"length"'),
    Bad("unknown name in a sole", "WG141", DESIGN, f'{DESIGN}\nsole = {{ @@length = "tigh", width = 0.1 }}', 'did you mean "thigh"?'),
    Bad("sole that is a number", "WG112", DESIGN, f"{DESIGN}\n@@sole = 0.2", "a table"),
    Bad("sole of a mirrored leg", "WG147", MIRROR, f"{MIRROR}\n@@sole = {{ length = 0.2, width = 0.1 }}", "sole"),
    Bad("negative weight", "WG161", "[generate]", "[adapt]\n@@limit_weight = -1\n[generate]", "negative"),
    Bad("unknown weight", "WG110", "[generate]", "[adapt]\n@@limit_wieght = 1.0\n[generate]", 'did you mean "limit_weight"?'),
    Bad("weight of text", "WG114", "[generate]", '[adapt]\n@@normal_weight = "much more"\n[generate]', "much"),
    Bad("weight of truth", "WG112", "[generate]", "[adapt]\n@@limit_weight = true\n[generate]", "true"),
    Bad("clearance in two units", "WG122", "[generate]", "[adapt]\nclearance = 0.3\n@@clearance_mm = 300\n[generate]", "clearance"),
    Bad("unknown name in a weight", "WG141", "[generate]", '[adapt]\n@@clearance = "2*tigh"\n[generate]', 'did you mean "thigh"?'),
    Bad("upper case", "WG130", 'name = "front_left"', '@@name = "Front-Left"', 'call it "front_left"'),
    Bad("comment mark", "WG130", 'name = "front_left"', '@@name = "a*/b"', "not a name"),
    Bad("quote", "WG130", 'name = "front_left"', "@@name = 'a\"b'", "not a name"),
    Bad("way out", "WG130", 'name = "mero"', '@@name = "../mero"', "not a name"),
    Bad("not ASCII", "WG130", 'name = "front_left"', '@@name = "vörn"', "not a name"),
    Bad("newline", "WG130", 'name = "front_left"', '@@name = "a\\nb"', "a\\nb"),
    Bad("too long", "WG130", 'name = "front_left"', f'@@name = "{"a" * 32}"', "30"),
    Bad("empty", "WG130", 'name = "front_left"', '@@name = ""', "not a name"),
    Bad("keyword of C", "WG131", 'name = "mero"', '@@name = "double"', "keyword of C"),
    Bad("keyword of C++", "WG131", 'name = "front_left"', '@@name = "co_await"', "keyword of C++"),
    Bad("keyword of Python", "WG131", 'name = "yaw"', '@@name = "lambda"', "keyword of Python"),
    Bad("library function", "WG131", "thigh = 0.35", "thigh = 0.35\n@@hypot = 1", "function of the C library"),
    Bad("constant", "WG131", "thigh = 0.35", "thigh = 0.35\n@@pi = 3", "constant"),
    Bad("own prefix", "WG131", 'name = "mero"', '@@name = "walkgen_x"', "prefix"),
    Bad("two platforms", "WG132", 'name = "middle"', '@@name = "front"', "twice"),
    Bad("two legs", "WG132", 'name = "front_right"', '@@name = "front_left"', "twice"),
    Bad("two joints", "WG132", 'name = "shank"', '@@name = "yaw"', "twice"),
    Bad("function names collide", "WG133", 'name = "front_right"', '@@name = "f32_front_left"', "mero_f32_front_left_foot_position"),
    Bad(
        "joint names collide",
        "WG133",
        f'name = "front_right"\n{MIRROR}',
        f'name = "front_right"\n{MIRROR}\nsource_names = ["a", "b", @@"b"]',
        "b",
    ),
    Bad("text with a comment mark", "WG134", 'description = "Three', '@@description = "*/Three', "comment mark"),
    Bad("control characters", "WG134", 'unit = "m"', '@@unit = "m\\u0007"', "control"),
    Bad("unknown parent", "WG140", 'parent = "front"', '@@parent = "frnt"', 'did you mean "front"?'),
    Bad("unknown chain", "WG140", 'chain = "waist"', '@@chain = "waste"', 'did you mean "waist"?'),
    Bad("unknown design", "WG140", 'design = "mero_leg"', '@@design = "mero"', 'did you mean "mero_leg"?'),
    Bad("unknown platform", "WG140", 'platform = "front"', '@@platform = "back"', "known platforms: front, middle"),
    Bad("unknown section", "WG140", 'section = "thigh_tube"', '@@section = "tigh_tube"', 'did you mean "thigh_tube"?'),
    Bad("mirror of nothing", "WG140", MIRROR, '@@mirror_of = "front_lift"', 'did you mean "front_left"?'),
    Bad(
        "unknown function name", "WG140", 'functions = "all"', 'functions = ["inverse", @@"foot_postion"]', 'did you mean "foot_position"?'
    ),
    Bad("unknown parameter", "WG141", '\na = "thigh"', '\n@@a = "tigh + 1"', 'did you mean "thigh"?'),
    Bad("unknown coordinate", "WG141", 'height = "0.1*sin(2*x) + 0.05*x*y"', '@@height = "0.1*sin(2*w)"', '"w"'),
    Bad("parameters in a circle", "WG142", "thigh = 0.35", '@@knee = "2*hip"\nhip = "knee/2"\nthigh = 0.35', "circle"),
    Bad(
        "platforms in a circle",
        "WG143",
        MIDDLE,
        REAR.format(parent="middle") + MIDDLE.replace('parent = "front"', '@@parent = "rear"'),
        "middle -> rear",
    ),
    Bad(
        "chain of no joints",
        "WG144",
        "[chain_designs.waist]",
        '[chain_designs.none]\n@@joints = []\ndh = "craig"\n[chain_designs.waist]',
        "no joints",
    ),
    Bad(
        "unused chain",
        "WG145",
        "[chain_designs.waist]",
        '[chain_designs.@@idle]\njoints = [{ name = "a", type = "prismatic", xyz = [0, 0, 0], axis = [0, 0, 1] }]\n[chain_designs.waist]',
        "no platform uses it",
    ),
    Bad("chain of the root", "WG145", 'name = "front"\n', 'name = "front"\n@@chain = "waist"\n', "joins nothing"),
    Bad("chain without parent", "WG145", 'parent = "front"\nchain', "@@chain", "no parent"),
    Bad("parent of the root", "WG146", 'name = "front"\n', 'name = "front"\n@@parent = "middle"\n', "root"),
    Bad("second root", "WG146", MIDDLE, '[[@@platforms]]\nname = "other"\n\n' + MIDDLE, "hangs on nothing"),
    Bad("no chain", "WG146", MIDDLE, '[[@@platforms]]\nname = "other"\nparent = "front"\n\n' + MIDDLE, "no chain joins"),
    Bad("mirrored leg with a mount", "WG147", MIRROR, f"{MIRROR}\n@@mount = {{ xyz = [0, 0, 0] }}", "mirror"),
    Bad("mirror of itself", "WG148", MIRROR, '@@mirror_of = "front_right"', "itself"),
    Bad("crossed limits", "WG160", "limits_deg = [-60, 60]", "@@limits_deg = [60, -60]", "write limits_deg = [-60, 60]"),
    Bad("crossed by a parameter", "WG160", "limits_deg = [-60, 60]", '@@limits_deg = ["100*thigh", "80*thigh"]', "crossed"),
    Bad("crossed bounds", "WG160", "bounds = [0.2, 0.6]", "@@bounds = [0.6, 0.2]", "crossed"),
    Bad("crossed domain", "WG160", "x = [-2.0, 2.0]", "@@x = [2.0, -2.0]", "crossed"),
    Bad("negative mass", "WG161", "mass = 12.0", "@@mass = -12.0", "negative"),
    Bad("no speed", "WG161", "max_speed_deg = 180", "@@max_speed_deg = 0", "more than 0"),
    Bad("negative modulus", "WG161", "E = 70e9", "@@E = -70e9", "more than 0"),
    Bad("triangle inequality", "WG162", LINK, LINK.replace("inertia = [0.002,", "@@inertia = [0.005,"), "triangle"),
    Bad(
        "not positive definite",
        "WG162",
        LINK,
        LINK.replace("inertia = [0.002, 0.002, 0.002, 0.0,", "@@inertia = [0.002, 0.002, 0.002, 0.0025,"),
        "positive definite",
    ),
    Bad("mass without inertia", "WG162", LINK, "link = { @@mass = 1.2 }", "has an inertia"),
    Bad("inertia without mass", "WG162", LINK, LINK.replace("mass = 1.2, com = [0.0, 0.0, 0.0], ", "@@"), "without mass"),
    Bad("outside its bounds", "WG163", "shank = { value = 0.40", "shank = { @@value = 0.70", "0.7 lies outside"),
    Bad("division by zero", "WG164", 'a = "shank"', '@@a = "shank/(thigh - 0.35)"', "division by zero"),
    Bad("root of a negative number", "WG164", 'a = "shank"', '@@a = "sqrt(thigh - shank)"', "no value"),
    Bad("value too large", "WG164", 'a = "shank"', '@@a = "(shank*1e300)**2"', "too large"),
    Bad("no direction", "WG166", "joints = [\n", 'joints = [\n  { name = "z", type = "revolute", @@axis = [0, 0, 0] },\n', "no direction"),
    Bad("runtime after runtime", "WG167", "shank = {", '@@heel = { value = "shank/8", runtime = true }\nshank = {', "shank"),
)
