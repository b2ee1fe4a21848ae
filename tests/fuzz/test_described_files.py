"""TOML and JSON are read within bounds at every door, in any encoding; beyond them one sentence refuses."""

import contextlib
import json

import pytest

from fuzz import corpus
from fuzz.damage import write
from fuzz.targets import TARGETS
from reliab.core.described_files import DEEPEST, parse_json, parse_toml, read_json, read_toml
from reliab.core.errors import InputError

DEEP = 600
MESSAGE = {"rule": "It must be sound", "remedy": "Mend it"}
HOSTILE_TOML = {
    "digits": f"name = {'9' * 5000}",
    "hexadecimal digits": f"name = 0x{'f' * 5000}",
    "more than 64 bits": f"name = {2**63}",
    "lists": f"name = {'[' * DEEP}{']' * DEEP}",
    "tables": f"name = {'{a = ' * DEEP}1{'}' * DEEP}",
    "lists that the parser takes": f"name = {'[' * 60}{']' * 60}",
    "a dotted name": f"{'a.' * 100_000}b = 1",
    "a dotted table": f"[{'a.' * 100_000}b]",
    "a quoted dotted name": f"""{'"a" . ' * 100_000}b = 1""",
    "infinity": "name = inf",
    "not a number": "name = nan",
    "beyond double precision": "name = 1e999",
}
HOSTILE_JSON = {
    "lists": f"{'[' * 100_000}{']' * 100_000}",
    "lists that the parser takes": f"{'[' * 60}{']' * 60}",
    "objects": '{"a":' * 100_000 + "1" + "}" * 100_000,
    "digits": "9" * 5000,
    "infinity": "Infinity",
}


@pytest.mark.parametrize("text", HOSTILE_TOML.values(), ids=HOSTILE_TOML)
def test_toml_beyond_its_bounds_is_refused(text):
    with pytest.raises(InputError, match=r"^a\.toml: "):
        parse_toml(text, where="a.toml", **MESSAGE)


@pytest.mark.parametrize("text", HOSTILE_JSON.values(), ids=HOSTILE_JSON)
def test_json_beyond_its_bounds_is_refused(text):
    with pytest.raises(InputError, match=r"^a\.json: "):
        parse_json(text, where="a.json", **MESSAGE)


def test_descriptions_within_the_bounds_are_read():
    deep_list = "[" * (DEEPEST - 2) + "]" * (DEEPEST - 2)
    assert parse_toml(f"a = {deep_list}", where="", **MESSAGE)["a"] is not None
    assert (
        parse_toml(f"a = {2**63 - 1}\nb = 'a.{'b.' * 50}'\n# {'c.' * 20}", where="", **MESSAGE)["a"]
        == 2**63 - 1
    )
    assert parse_json("999999999999999999999", **MESSAGE) == pytest.approx(1e21)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_descriptions_are_read_in_the_encodings_of_windows(tmp_path, encoding):
    (tmp_path / "a.toml").write_bytes("name = 'Küche'\r\n".encode(encoding))
    (tmp_path / "a.json").write_bytes('{"name": "Küche"}\r\n'.encode(encoding))
    for read, file in ((read_toml, "a.toml"), (read_json, "a.json")):
        assert read(tmp_path / file, **MESSAGE) == {"name": "Küche"}


DESCRIPTIONS = ("campaign", "study", "model", "frame")


@pytest.mark.parametrize("name", DESCRIPTIONS)
@pytest.mark.parametrize("hostile", HOSTILE_TOML.values(), ids=HOSTILE_TOML)
def test_every_door_refuses_hostile_toml(tmp_path, name, hostile):
    case = TARGETS[name].seeds()[0]
    file = next(file for file in case if file.endswith(".toml"))
    write({**case, file: f"{hostile}\n".encode() + case[file]}, tmp_path)
    with pytest.raises(InputError):
        TARGETS[name].read(tmp_path)


@pytest.mark.parametrize("hostile", HOSTILE_JSON.values(), ids=HOSTILE_JSON)
def test_a_hostile_manifest_is_no_run(tmp_path, hostile):
    from reliab.study.stages import study_of

    for text in (hostile, "[]", '{"study": [], "stages": {}}', json.dumps({"study": {}, "stages": {"a": 1}})):
        (tmp_path / "manifest.json").write_text(text)
        with pytest.raises(InputError, match="This is no folder of a run"):
            study_of(tmp_path)


VALUES = (None, "x", "1", -1, 0, True, [], {}, [["x"]], {"name": "x"}, 1e308, 2**70)


def places(content, place=()):
    """Every place in what JSON holds, the whole first."""
    yield place
    inner = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    for key, value in inner:
        yield from places(value, (*place, key))


def replace_value(content, place, value):
    """Put a value in a place of what JSON holds."""
    if not place:
        return value
    first, *deeper = place
    copy = dict(content) if isinstance(content, dict) else list(content)
    copy[first] = replace_value(content[first], deeper, value)
    return copy


@pytest.mark.slow
def test_every_value_of_a_criterion_may_be_anything():
    """Each key in turn holds each of the values above; of long lists the first three places."""
    from reliab.criterion.criterion import Criterion

    text = json.loads(corpus.criteria()[2]["criterion.json"])
    places_of_numbers = [
        place for place in places(text) if all(not isinstance(key, int) or key < 3 for key in place)
    ]
    assert len(places_of_numbers) > 60
    for place in places_of_numbers:
        for value in VALUES:
            with contextlib.suppress(InputError):
                criterion = Criterion.from_json(json.dumps(replace_value(text, place, value)))
                criterion.limits(1.0, 0.02)
                criterion.probability(1.001, 0.001, 1.0, 0.02)
