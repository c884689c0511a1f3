"""A cam as a DXF to cut by, in mm."""

from io import StringIO

import ezdxf
from ezdxf import units

from walkgen.design.cam import Profile


def dxf(found: Profile) -> str:
    """Edge and way of the roller's centre as polylines on layers of their own, the hip as a point; the same text for the same cam."""
    ezdxf.options.write_fixed_meta_data_for_testing = True  # no dates
    drawing = ezdxf.new("R2010", units=units.MM)
    space = drawing.modelspace()
    for layer, points in (("EDGE", found.contact), ("PITCH", found.pitch)):
        drawing.layers.add(layer)
        space.add_lwpolyline([(float(x), float(y)) for x, y in 1e3 * points], dxfattribs={"layer": layer})
    drawing.layers.add("HIP")
    space.add_point((0.0, 0.0), dxfattribs={"layer": "HIP"})
    out = StringIO()
    drawing.write(out)
    return out.getvalue()
