"""Every kind of bad input, over all commands: one line on standard error, exit code 2, nothing written."""

import json
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shared import move

from move import paths, yaml_text
from move.cli.study import read_parameters
from move.errors import BadInput
from move.figures import names
from move.figures.page import parameters
from move.study import profiles
from move.study.profiles import load_profile

LONG = "n" * 300
PLACES = ["", ".", "/", "..", "file", "file/x.zarr", "/dev/full", "/dev/null/x", "/proc/x.zarr", LONG, f"{LONG}/x"]
BOMB = "[&a [x, x], &b [*a, *a], &c [*b, *b], &d [*c, *c], *d]"
YAML = {
    "alias bomb": (BOMB, "alias"), "recursive alias": ("&a [*a]", "alias"), "an unknown anchor": ("*nowhere", "alias"),
    "deep lists": ("[" * 20_000 + "]" * 20_000, "recursion"), "deep and never closed": ("[" * 20_000, "recursion"),
    "a python tag": ("!!python/object/apply:os.system [echo]", "python/object"), "a set": ("!!set {a, b}", "set"),
    "a tagged number": ("!!int 0x64", "tag"), "an unknown tag": ("!mine 5", "mine"),
    "a leading zero": ("03500", "write the number as 3500"), "a grouped number": ("1_000", "write the number as 1000"),
    "1e3": ("1e3", "write the number as 1000"), "1e-4 in a list": ("[0.1, 1e-4]", "write the number as 0.0001"),
    "1e-5 in a mapping": ("{a: {b: 1e-5}}", "a: b: '1e-5' is text to YAML; write the number as 1.0e-05"),
    "a list that never ends": ("[1, 2", "not readable"), "three colons": ("a: b: c", "not readable"),
    "an escape": ("\x1b[31m", "not readable"), "a key twice": ("{a: 1, a: 2}", "'a' stands twice"),
    "equal keys": ("{1: 1, 1.0: 2}", "stands twice"), "a list as a key": ("{[a]: 1}", "unhashable"),
    "two documents": ("1\n---\n2", "not readable"), "a number of 10,000 digits": ("9" * 10_000, "not readable"),
    "too long": ("x" * 1_000_001, "allowed are 1,000,000"),
}


def everything(folder: Path) -> list[tuple[str, bytes]]:
    return sorted((str(path), path.read_bytes() if path.is_file() else b"") for path in folder.rglob("*"))


def refused(capsys, folder: Path, message: str, *arguments: str) -> None:
    """The command is refused in one line that holds `message`, and `folder` stays what it was."""
    before = everything(folder)
    code, out, err = move(capsys, *arguments)
    assert (code, out) == (2, ""), err
    assert err.count("\n") == 1 and err.startswith("move: ") and "Traceback" not in err
    assert message in err and len(err) < 1200
    assert everything(folder) == before


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A working folder that holds a file, a thesis, and neither data nor a policy."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis/chapter1.txt").write_text("mine")
    (tmp_path / "empty").mkdir()
    return tmp_path


COMMANDS = [
    (("collect", "--task", "juggling"), "'juggling' is not one of 'pick-place'"),
    (("collect", "--method", "magic"), "'magic' is not one of 'static', 'adc', 'move', 'mixture'"),
    (("collect", "--timesteps", "-5"), "timesteps: -5 given; input should be greater than 0"),
    (("collect", "--timesteps", "few"), "--timesteps: 'few' given; input should be a valid integer"),
    (("placements", "--places", "0"), "--places: '0' given; input should be greater than or equal to 1"),
    (("collect", "--timesteps", "1e3"), "valid integer"),
    (("collect", "--timesteps", str(10**12)), "less than or equal to 100000000"),
    (("collect", "--timesteps", "9" * 5000), "--timesteps"),
    (("collect", "--image-size", "64"), "image_size: 64 given with keypoints"),
    (("collect", "--observation", "rgb", "--image-size", "-4"), "image_size: -4 given"),
    (("collect", "--observation", "rgb", "--image-size", "9999"), "less than or equal to 512"),
    (("collect", "--factors", "moon"), "'moon' is not one of 'object', 'object+hand', 'object+target', 'all'"),
    (("collect", "--protocol", "sparse", "--factors", "all"), "factors: 'all' given with protocol 'sparse'"),
    (("collect", "--method", "static", "--object-speed", "0.1"), "object_speed: 0.1 given; nothing moves at"),
    (("collect", "--object-speed", "inf"), "object_speed: inf given"),
    (("collect", "--moving", "moon"), "'moon' given"),
    (("collect", "--moving", "object,object"), "each once"),
    (("collect", "--method", "mixture"), "a mixture of nothing"),
    (("collect", "--method", "mixture", "--shares", "static=nan,move=0.5"), "shares"),
    (("collect", "--method", "mixture", "--shares", "static=0.5,move=0.6"), "shares add up to 1.1"),
    (("collect", "--method", "mixture", "--shares", "static=0.5,move=0.1,move=0.5"), "methods, each once"),
    (("placements", "--within", "1_0,0,4_0,3_0"), "within: '1_0,0,4_0,3_0' given"),
    (("collect", "--shares", "static=0.5,move=0.5"), "shares given for method 'move'; allowed with mixture"),
    (("collect", "--seed", "-1"), "--seed"),
    (("collect", "--seed", str(10**30)), "--seed"),
    (("collect", "--tiemsteps", "5"), "No such option: --tiemsteps"),
    (("collect", "--out", "thesis", "--timesteps", "50"), "thesis exists and is not"),
    (("collect", "--out", "thesis", "--overwrite"), "thesis exists and is not"),
    (("collect", "--out", "empty", "--overwrite"), "empty exists and is not"),
    (("export", "nowhere.zarr", "out"), "no demonstrations at nowhere.zarr"),
    (("export", "thesis", "out"), "cannot read demonstrations from thesis"),
    (("export", "nowhere.zarr", "thesis"), "thesis exists; allowed is a new folder"),
    (("export", "nowhere.zarr", "out", "--format", "hdf5"), "'hdf5' is not one of 'lerobot', 'zarr'"),
    (("export", "nowhere.zarr"), "Missing argument"),
    (("train", "nowhere.zarr", "out"), "no demonstrations at nowhere.zarr"),
    (("train", "thesis", "out"), "cannot read demonstrations from thesis: this is no zarr group"),
    (("train", "nowhere.zarr", "thesis"), "thesis holds chapter1.txt, not of a checkpoint"),
    (("train", "nowhere.zarr", "out", "--profile", "moon"), "profile: 'moon' given"),
    (("train", "nowhere.zarr", "out", "--gradient-steps", "x"), "valid integer"),
    (("evaluate", "nowhere"), "no checkpoint in nowhere"),
    (("evaluate",), "checkpoint: none given"),
    (("evaluate", "--agent", "dog"), "'dog' is not one of 'policy', 'nothing'"),
    (("evaluate", "nowhere", "--agent", "nothing"), "agent: more than one given; allowed is one of CHECKPOINT"),
    (("evaluate", "--agent", "nothing", "--episodes", "-1"), "episodes: -1 given"),
    (("evaluate", "--agent", "nothing", "--episodes", str(10**9)), "less than or equal to 100000"),
    (("evaluate", "--agent", "nothing", "--starts", "own"), "'own' is not one of 'random', 'moving', 'grid'"),
    (("evaluate", "--agent", "nothing", "--starts", "grid", "--episodes", "5"), "episodes: given with starts 'grid'"),
    (("evaluate", "--agent", "nothing", "--starts", "grid", "--factors", "all"), "factors: given with starts 'grid'"),
    (("run", "--profile", "moon"), "profile: 'moon' given; allowed are"),
    (("evaluate", "--agent", "expert", "--profile", "moon"), "profile: 'moon' given; allowed are"),
    (("run", "--profile", "../profiles/laptop"), "profile: '../profiles/laptop' given"),
    (("run", "fig99"), "figure: 'fig99' given"),
    (("run", "table4"), "needs no runs; allowed are fig1_sparse"),
    (("run", "--workers", "0"), "--workers"),
    (("run", "--cluster", "nowhere"), "cluster: 'nowhere' given"),
    (("run", "--results", ""), "results: '' given; allowed is a folder's name"),
    (("run", "--results", "file"), "cannot write file/result.json: Not a directory"),
    (("run", "--results", "/proc/x"), "cannot write"),
    (("plan", "fig1", "-p", "budget=5"), "fig1_sparse has no parameter budget"),
    (("plan", "fig1", "-p", "seeds=100000000"), "less than or equal to 100"),
    (("plan", "table2", "-p", "seeds=1000"), "less than or equal to 100"),
    (("plan", "fig7", "-p", "camera_tasks=[x]"), "camera_tasks: 'x' given; allowed are pick-place"),
    (("plan", "-p", "timesteps=5"), "allowed with the figures that it is for"),
    (("plan", "claims"), "needs no runs"),
    (("verify", "--sample", "0"), "--sample"),
    (("verify", "fig1", "--all"), "given with --all"),
    (("verify", "0123456789abcdef", "--all"), "given with --all"),
    (("verify", "deadbeef"), "'deadbeef' given; allowed is the whole hash"),
    (("verify", "0123456789abcdef"), "'0123456789abcdef' given; allowed is the hash of a run stored in"),
    (("verify", "0123456789abcdef", "fig1"), "given with fig1_sparse"),
    (("verify", "0123456789abcdef", "--seed", "1"), "given with --sample or --seed"),
    (("verify", "--profile", "paper"), "no stored result"),
    (("figure", "fig99"), "figure: 'fig99' given"),
    (("figure", "fig11"), "figure: 'fig11' given (fig1?)"),
    (("figure", "../notebooks/fig1_sparse"), "figure: '../notebooks/fig1_sparse' given"),
    (("figure", "fig1", "-p", "timesteps"), "allowed is name=value"),
    (("figure", "fig1", "-p", "a b=5"), "allowed is name=value"),
    (("figure", "fig1", "-p", "profile=smoke"), "-p profile: allowed is --profile smoke"),
    (("figure", "fig1", "-p", "seeds=1", "-p", "seeds=2"), "-p seeds: given twice"),
    (("doctor", "surplus"), "unexpected extra argument"),
    (("dance",), "No such command 'dance'"),
]


@pytest.mark.parametrize(("arguments", "message"), COMMANDS, ids=[" ".join(command)[:60] for command, _ in COMMANDS])
def test_a_bad_command_is_one_line(capsys, here, arguments, message):
    refused(capsys, here, message, *arguments)


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place[:20] or "empty")
@pytest.mark.parametrize("command", ["collect", "export", "train"])
def test_a_place_that_cannot_be_written_is_refused_before_the_work(capsys, here, monkeypatch, command, place):
    for slow in ("move.sim.collect.collect", "move.learn.dataset.load", "move.learn.train.train"):
        monkeypatch.setattr(slow, lambda *a, **k: pytest.fail("the work began"))
    arguments = {"collect": ("collect", "--out", place, "--overwrite"), "export": ("export", "data", place),
                 "train": ("train", "data", place)}
    refused(capsys, here, "", *arguments[command])


@pytest.mark.parametrize("name", YAML)
def test_bad_yaml_is_refused_in_one_line(name):
    text, message = YAML[name]
    with pytest.raises(BadInput, match="^here: ") as caught:
        yaml_text.read(text, "here")
    assert message in str(caught.value) and "\n" not in str(caught.value) and len(str(caught.value)) < 400


@pytest.mark.parametrize("name", ["alias bomb", "a python tag", "1e3"])
def test_bad_yaml_in_a_parameter_and_in_a_profile(capsys, here, profile_file, name):
    text, message = YAML[name]
    refused(capsys, here, message, "figure", "fig1", "--profile", "smoke", "-p", f"timesteps={text}")
    profile_file.write_text(f"purpose: {text}\n")
    refused(capsys, here, message, "run", "--profile", "smoke")


@pytest.fixture(scope="module")
def smoke_text():
    return (paths.PROFILES / "smoke.yaml").read_bytes()


@pytest.fixture
def profile_file(here, monkeypatch, smoke_text):
    """The smoke profile as the only one, to be damaged."""
    folder = here / "profiles"
    folder.mkdir()
    monkeypatch.setattr(profiles, "PROFILES", folder)
    (folder / "smoke.yaml").write_bytes(smoke_text)
    return folder / "smoke.yaml"


@pytest.mark.parametrize(("old", "new", "message"), [
    (b"purpose:", b"purpose: \xff\xfe", "not readable as YAML"),
    (b"stamp: SMOKE", b"stamp: SMOKE\nstamp: SMOKE", "'stamp' stands twice"),
    (b"stamp: SMOKE", b"stamp: 5", "stamp: 5 given"),
    (b"image_size: 48", b"image_sizes: 48", "image_sizes"),
    (b"keypoints: 0.1", b"keypoints: -5", "minutes.keypoints: -5"),
    (b"keypoints: 0.1", b"keypoints: .nan", "minutes.keypoints: nan given"),
    (b"fig1_sparse:", b"fig1_sparks:", "no notebook fig1_sparks"),
    (b"gradient_steps: 60", b"gradient_steps: 1000000000", "less than or equal to 10000000"),
    (b"gradient_steps: 60", b"gradient_steps: true", "valid integer"),
    (b"gradient_steps: 60", b"gradient_steps: -60", "greater than 0"),
    (b"batch_size: 64", b"batch_size: '64a'", "valid integer"),
    (b"timesteps: 300", b"timesteps: 0", "greater than 0"),
    (b"denoiser: mlp", b"denoiser: mlp\n    mlp_width: 10000000", "less than or equal to 16384"),
    (b"learning_rate: 1.0e-3", b"learning_rate: 1e-3", "write the number as 0.001"),
    (b"seeds: 1,", b"seeds: 100000000,", "less than or equal to 100"),
    (b"seeds: 1,", b"seeds: 010,", "write the number as 10"),
    (b"stamp: SMOKE", b"shipped: yes", "shipped: 'yes' given"),
    (b"learning_rate: 1.0e-3", b"learning_rate: 1.0e+300", "less than or equal to 1"),
    (b"image_size: 48", b"image_size: 16", "of images of 16 pixels"),
    (b"stamp: SMOKE", b"stamp: SMOKE\ngradient_steps: {keypoints: {100: 60, 200: 1}}", "no fewer for more data"),
    (b"stamp: SMOKE", b"stamp: SMOKE\ngradient_steps: {keypoints: {100: 60, 300: 80, 200: 90}}", "no fewer for more"),
    (b"stamp: SMOKE", b"stamp: SMOKE\ngradient_steps: {keypoints: {100: 60, 10000000000: 70}}", "less than or equal"),
    (b"stamp: SMOKE", b"stamp: SMOKE\nshares_results: /etc", "shares_results: '/etc' given"),
    (b"stamp: SMOKE", b"stamp: SMOKE\ncollection: {move: {timesteps: 5}}", "'timesteps' given; allowed are image_size"),
    (b"timesteps: 300", b"budget: 300", "no parameter budget"),
    (b"observation: rgb", b"observation: smell", "observation: 'smell' given"),
])
def test_a_bad_profile_is_one_line(capsys, here, profile_file, smoke_text, old, new, message):
    assert old in smoke_text
    profile_file.write_bytes(smoke_text.replace(old, new, 1))
    refused(capsys, here, message, "run", "--profile", "smoke")


@pytest.mark.parametrize("content", [b"", b"5", b"null", b"[]", b"{}", b"a: b"])
def test_a_profile_that_is_none_is_one_line(capsys, here, profile_file, content):
    profile_file.write_bytes(content)
    refused(capsys, here, "smoke.yaml: ", "run", "--profile", "smoke")


VALUES = [
    ("fig1", "timesteps=abc", "timesteps: 'abc' given; input should be a valid integer"),
    ("few_demonstrations", "timesteps=7000", "timesteps: 7000 given; input should be a list, in brackets"),
    ("fig1", "timesteps=true", "timesteps: True given"),
    ("fig1", "timesteps=null", "timesteps: None given"),
    ("fig1", "timesteps=03500", "write the number as 3500"),
    ("fig1", "timesteps=1:40", "timesteps: '1:40' given"),
    ("fig1", "timesteps=0x64", "timesteps: '0x64' given"),
    ("fig1", "timesteps=2024-10-01", "timesteps: '2024-10-01' given"),
    ("fig1", "seeds=on", "seeds: 'on' given"),
    ("fig1", "seeds=101", "less than or equal to 100"),
    ("fig3", "timesteps=[300,300]", "timesteps: 300 given twice"),
    ("fig4", "tasks=[push,push]", "tasks: push given twice"),
    ("fig4", "tasks=[push,moon]", "tasks: 'moon' given"),
    ("fig7", "camera_tasks=[x]", "camera_tasks: 'x' given"),
    ("table2", f"most_timesteps={10**30}", "less than or equal to 100000000"),
    ("fig4", f"timesteps=[{','.join(map(str, range(1, 102)))}]", "101 values given; allowed are 100"),
    ("fig1", "observation=smell", "observation: 'smell' given"),
    ("fig3", "timesteps=[]", "timesteps"),
    ("fig7", "speeds=[9]", "less than or equal to 0.3"),
    (next(name for name in names() if "shares" in parameters.defaults(name)), "shares=[1.5]", "than or equal to 1"),
    ("rollouts", "task=nope", "task: 'nope' given"),
    ("rollouts", "frames=0", "frames: 0 given"),
    ("rollouts", "seed=-1", "seed: -1 given"),
    ("demonstrations", "tasks=pick-place", "tasks: 'pick-place' given"),
    ("fig2", "image_size=9999", "image_size: 9999 given"),
    ("fig2", "rotating_task=5", "rotating_task: '5' given"),
    ("fig2", "timesteps=-1", "timesteps: -1 given"),
    ("fig8", "dataset=a\x1bb", "characters that can be printed"),
    ("fig8", "revision=main", "revision: 'main' given"),
    ("fig8", "size_cap_gb=-1", "size_cap_gb: -1 given"),
    ("fig8", "episodes=0", "episodes: 0 given"),
    ("table4", "compared=[moon]", "profile: 'moon' given"),
    ("statistics", "draws=0", "draws: 0 given"),
    ("statistics", "seeds=[]", "seeds"),
]


@pytest.mark.parametrize(("name", "assignment", "message"), VALUES, ids=lambda value: value[:30])
def test_a_bad_value_is_refused_before_a_kernel_starts(capsys, here, monkeypatch, name, assignment, message):
    monkeypatch.setattr("papermill.execute_notebook", lambda *a, **k: pytest.fail("a kernel was started"))
    refused(capsys, here, message, "figure", name, "-p", assignment)


def test_what_the_hints_say_is_accepted():
    profile = load_profile("smoke")
    for text in ("1e3", "2E2", "1e-4", "1e-7", "'5'", "1e300", "-1e4"):
        with pytest.raises(BadInput, match="write the number as ") as caught:
            yaml_text.read(text, "here")
        hint = str(caught.value).split("write the number as ")[1]
        assert yaml_text.read(hint, "here") == float(text.strip("'"))
    assert isinstance(yaml_text.read("1000", "here"), int)
    given = {"timesteps": yaml_text.read("1000", "here")}
    assert parameters.parameters("fig1_sparse", profile, given)["timesteps"] == 1000


@pytest.mark.parametrize("text", ["2024-10-01", "run #3", "on", "5", "1e3", "0x64", "[a]", "~", "", "a: b", " x ", "ö"])
def test_a_parameter_that_is_text_is_taken_as_it_stands(text):
    known = parameters.texts("fig8_real_setup")
    assert known == {"dataset", "revision", "units_file"} and parameters.texts("table3_real") == {"sheet"}
    given = read_parameters([f"dataset={text}", "episodes=5"], known)
    assert parameters.parameters("fig8_real_setup", load_profile("smoke"), given)["dataset"] == text
    assert given["episodes"] == 5


@pytest.mark.parametrize(("text", "value"), [
    ("0", 0), ("-7", -7), ("+12", 12), ("1.5", 1.5), (".5", 0.5), ("-1.0e-4", -1e-4), ("5.", 5.0), ("true", True),
    ("null", None), ("", None), ("on", "on"), ("No", "No"), ("1:40", "1:40"), ("0x1F", "0x1F"), ("1:3:4", "1:3:4"),
    ("2024-10-01", "2024-10-01"), ("=", "="), ("[on, 1]", ["on", 1]), ("{<<: 1}", {"<<": 1}), ("'on'", "on"),
])
def test_scalars_are_those_of_yaml_1_2(text, value):
    read = yaml_text.read(text, "here")
    assert read == value and type(read) is type(value)


def test_many_keys_are_read_in_no_time():
    started = time.process_time()
    text = "".join(f"k{number}: 1\n" for number in range(10_000))
    assert len(yaml_text.read(text, "here")) == 10_000
    with pytest.raises(BadInput, match="'k9999' stands twice"):
        yaml_text.read(f"{text}k9999: 2", "here")
    assert time.process_time() - started < 20


def test_every_parameter_of_every_figure_is_checked():
    """A mapping is no value of any of them."""
    for name in names():
        for key in parameters.defaults(name):
            with pytest.raises(BadInput, match=f"{name}: {key}"):
                parameters.parameters(name, load_profile("laptop"), {key: {"a": 1}})


@pytest.mark.parametrize("profile", profiles.names())
def test_what_the_profiles_themselves_choose_is_allowed(profile):
    chosen = load_profile(profile)
    for name in names():
        assert parameters.parameters(name, chosen).keys() == parameters.defaults(name).keys()


VALUE = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
    | st.sampled_from(["rgb", "pick-place", 1, 0.5, -1, 10**20]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=6)


@settings(max_examples=300, deadline=None)
@given(text=st.text(max_size=60) | st.text("[]{}&*!:,-'\"\n a1|>#%@`?", max_size=40) | VALUE.map(json.dumps))
def test_any_text_is_read_as_plain_values_or_refused_in_one_line(text):
    try:
        content = yaml_text.read(text, "here")
    except BadInput as problem:
        assert "\n" not in str(problem)
    else:
        json.dumps(content)


@settings(max_examples=100, deadline=None)
@given(name=st.sampled_from(["fig1_sparse", "fig3_dense", "rollouts", "fig2_overview", "fig8_real_setup"]),
       number=st.integers(0, 20), value=VALUE)
def test_any_value_of_a_parameter_is_taken_or_refused_in_one_line(name, number, value):
    known = list(parameters.defaults(name))
    try:
        parameters.parameters(name, load_profile("smoke"), {known[number % len(known)]: value})
    except BadInput as problem:
        assert "\n" not in str(problem)


@settings(max_examples=100, deadline=None)
@given(changed=st.dictionaries(st.sampled_from(sorted(profiles.Profile.model_fields)), VALUE, max_size=4))
def test_any_content_of_a_profile_is_taken_or_refused(changed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("profiles")
    (folder / "any.yaml").write_text(json.dumps({"purpose": "test", "training": {}, "notebooks": {}} | changed))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(profiles, "PROFILES", folder)
        try:
            load_profile("any")
        except BadInput as problem:
            assert "\n" not in str(problem)
