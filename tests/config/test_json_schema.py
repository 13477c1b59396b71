"""What `--describe-config=json` prints is true: the shipped files are valid by it, and its ranges are the reader's."""

import json
import math
import subprocess

import pytest
import yaml

from bench.common.configuration import shipped_coordinator
from pilotfish import base, coordinator, data
from pilotfish.harness.executables import find_executable

PROGRAMS = {"coordinator": "pilotfish-coordinator", "base": "pilotfish-base"}
LOAD = {"coordinator": coordinator.load_coordinator, "base": base.load_base}
TYPES = {"number": (int, float), "integer": int, "boolean": bool, "string": str, "array": list, "object": dict}
KNOWN = {"type", "description", "default", "minimum", "maximum", "enum", "items", "minItems", "maxItems"} | {
    "properties", "additionalProperties", "required", "$schema", "title"
}  # fmt: skip
OTHER_LEADER = {"leader": str(data.path("leaders/three_faces_second.yaml")), "distance_m": 1.0}  # of a list


@pytest.fixture(scope="module")
def schemas():
    def printed(program):
        done = subprocess.run([find_executable(program), "--describe-config=json"], capture_output=True, check=True)
        return json.loads(done.stdout)

    return {who: printed(program) for who, program in PROGRAMS.items()}


def shipped(who):
    return shipped_coordinator() if who == "coordinator" else yaml.safe_load(data.path("config/base.yaml").read_text())


def faults(value, schema, path=""):
    """What is wrong with a value, by the words of JSON schema that this one uses, and no others."""
    assert set(schema) <= KNOWN, "a word that this does not know"
    kind = schema["type"]
    if not isinstance(value, TYPES[kind]) or (kind in {"number", "integer"} and isinstance(value, bool)):
        return [f"{path}: {value!r} is no {kind}"]
    if kind in {"number", "integer"} and not schema["minimum"] <= value <= schema["maximum"]:
        return [f"{path}: {value} is outside"]
    if "enum" in schema and value not in schema["enum"]:
        return [f"{path}: {value} is none of {schema['enum']}"]
    if kind == "array":
        wrong = [] if schema["minItems"] <= len(value) <= schema["maxItems"] else [f"{path}: {len(value)} items"]
        return wrong + [fault for each in value for fault in faults(each, schema["items"], path)]
    if kind != "object":
        return []
    assert schema["additionalProperties"] is False
    wrong = [f"{path}: lacks {key}" for key in schema.get("required", []) if key not in value]
    for key, each in value.items():
        where = f"{path}.{key}".strip(".")
        part = schema["properties"].get(key)
        wrong += faults(each, part, where) if part else [f"{where}: unknown"]
    return wrong


def ranges(schema, path=()):
    """(keys, schema of the number, whether it is one of three) of every number."""
    for key, part in schema.get("properties", {}).items():
        if part["type"] == "array" and part["items"]["type"] == "object":
            yield from ranges(part["items"], (*path, f"{key}[0]"))
        elif part["type"] == "array":
            yield (*path, key), part["items"], True
        elif "minimum" in part:
            yield (*path, key), part, False
        else:
            yield from ranges(part, (*path, key))


def changed(config, keys, value):
    """A copy in which a number stands at a dotted place, and no other angle beside it in the other unit."""
    copy = json.loads(json.dumps(config))
    section = copy
    for key in keys[:-1]:
        section = (
            section.setdefault(key[:-3], [dict(OTHER_LEADER)])[0] if key[-3:] == "[0]" else section.setdefault(key, {})
        )
    for unit, other in (("_rad", "_deg"), ("_deg", "_rad")):
        if keys[-1].endswith(unit):
            section.pop(keys[-1].removesuffix(unit) + other, None)
    section[keys[-1]] = value
    return copy


@pytest.mark.parametrize("file", sorted(path.name for path in data.path("config").glob("*.yaml")))
def test_the_shipped_configurations_are_valid_by_the_schema(schemas, file):
    schema = schemas["base" if file == "base.yaml" else "coordinator"]
    assert faults(yaml.safe_load(data.path(f"config/{file}").read_text()), schema) == []


@pytest.mark.parametrize(
    ("keys", "value", "fault"),
    [
        (("control", "limits", "max_linear_mps"), 9.0, "control.limits.max_linear_mps: 9.0 is outside"),
        (("control", "limits", "wings"), 2, "control.limits.wings: unknown"),
        (("control", "limits"), 2, "control.limits: 2 is no object"),
        (("setpoint", "run"), 1, "setpoint.run: 1 is no boolean"),
        (("alternatives", "leaders[0]", "distance_m"), 21.0, "alternatives.leaders.distance_m: 21.0 is outside"),
        (("alternatives", "leaders[0]", "wings"), 2, "alternatives.leaders.wings: unknown"),
        (("profile",), "fast", "profile: fast is none of ['paper', 'anticipate']"),
        (("camera", "mounting", "position_m"), [0.0, 0.0], "camera.mounting.position_m: 2 items"),
    ],
)
def test_what_is_wrong_is_invalid_by_the_schema(schemas, keys, value, fault):
    assert faults(changed(shipped("coordinator"), keys, value), schemas["coordinator"]) == [fault]


@pytest.mark.parametrize("who", PROGRAMS)
def test_every_range_of_the_schema_is_the_reader_s(schemas, who, tmp_path):
    """At its ends a number is within, a millionth of the range (or one) farther it is outside: of every key."""
    file = tmp_path / "config.yaml"

    def complaint(keys, value):
        file.write_text(yaml.safe_dump(changed(shipped(who), keys, value)))
        try:
            LOAD[who](file)
        except ValueError as error:  # ends that do not go together with what else is configured are refused otherwise
            return str(error)
        return ""

    seen = 0
    for keys, number, of_three in ranges(schemas[who]):
        whole = number["type"] == "integer"
        low, high = (int(end) if whole else end for end in (number["minimum"], number["maximum"]))
        step = 1 if whole else 1e-6 * (high - low)
        assert math.isfinite(low) and low < high, keys
        for value, within in ((low, True), (high, True), (low - step, False), (high + step, False)):
            said = complaint(keys, [value, 0.0, 0.0] if of_three else value)
            assert ("is outside [" in said) is not within, (keys, value, said)
            assert within or said.startswith(".".join(keys)), said
        seen += 1
    assert seen >= {"coordinator": 60, "base": 14}[who]


@pytest.mark.parametrize("program", PROGRAMS.values())
def test_help_says_in_which_forms_the_configuration_is_described(program):
    done = subprocess.run([find_executable(program), "--help"], capture_output=True, text=True, check=True)
    assert "--describe-config [markdown|json]" in done.stdout
    assert "{markdown}" not in done.stdout


@pytest.mark.parametrize("program", PROGRAMS.values())
def test_another_form_and_no_configuration_at_all_end_with_64(program):
    for arguments in (["--describe-config=xml"], []):
        assert subprocess.run([find_executable(program), *arguments], capture_output=True).returncode == 64
