"""The JSON Schema that editors use: deterministic, of every key, and strict."""

import json
import os
import subprocess
import sys

from walkgen.spec.schema import schema_json


def test_schema_knows_every_table_and_refuses_others() -> None:
    schema = json.loads(schema_json())
    assert set(schema["required"]) == {"walkgen", "robot"}
    assert {"platforms", "legs", "leg_designs", "chain_designs", "sections", "parameters", "terrain", "generate"} < set(
        schema["properties"]
    )
    assert schema["additionalProperties"] is False
    joint = schema["$defs"]["JointRow"]
    assert {"alpha", "alpha_deg", "a_mm", "limits_deg", "link"} < set(joint["properties"])
    assert joint["properties"]["type"]["enum"] == ["revolute", "prismatic"]
    assert joint["properties"]["d"]["description"]


def test_schema_is_the_same_text_everywhere() -> None:
    command = [sys.executable, "-c", "from walkgen.spec.schema import schema_json; print(schema_json(), end='')"]
    texts = [
        subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True).stdout
        for seed in ("1", "2")
    ]
    assert texts == [schema_json()] * 2
    assert texts[0].endswith("}\n")
