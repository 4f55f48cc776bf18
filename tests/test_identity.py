"""Data, policies, results and the source that decides them are what they say, or refused."""

import dataclasses
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from distributed import LocalCluster
from recipes import tiny
from shared import move, refused
from test_cluster import two_threads

import move as package
from move import paths
from move.errors import BadInput
from move.figures.page import captions, parameters
from move.learn.dataset import load, save
from move.learn.train import train
from move.sim.demonstrations import Demonstrations, fingerprint
from move.study import cluster, execute, policies, provenance, results, run, seals, verify
from move.study.kinds import collector_run, control_run, policy_run
from move.study.profiles import Profile, load_profile
from move.study.spec import PolicyRun

LAPTOP = load_profile("laptop")
SHIPPED = parameters.specs("rollouts", LAPTOP)


def numbers(seed: int = 0) -> Demonstrations:
    rng = np.random.default_rng(seed)
    return Demonstrations(rng.normal(size=(40, 3)).astype(np.float32),
                          rng.uniform(-1, 1, (40, 2)).astype(np.float32), np.array([15, 40]))


# data ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change", ["an observation", "its shape", "its type", "an action", "the ends"])
def test_a_fingerprint_covers_everything(change):
    made = numbers()
    seen, actions, ends = made.observations.copy(), made.actions.copy(), made.episode_ends
    match change:
        case "an observation":
            seen[7, 2] = np.nextafter(seen[7, 2], 9, dtype=np.float32)
        case "its shape":
            seen = seen.reshape(20, 6)
        case "its type":
            seen = seen.view(np.int32)
        case "an action":
            actions[39, 1] *= -1
        case "the ends":
            ends = np.array([16, 40])
    assert fingerprint(seen, actions, ends) != made.fingerprint == numbers().fingerprint


def test_training_into_one_folder_from_data_that_only_look_different_is_refused(capsys, tmp_path):
    for name, camera in (("A", ()), ("B", ("--camera-speed", "0.0001"))):
        command = ("collect", "--timesteps", "200", "--seed", "3", "--out", str(tmp_path / name), *camera)
        assert move(capsys, *command)[0] == 0
    one, other = (load(tmp_path / name)[0] for name in "AB")
    assert np.array_equal(one.actions, other.actions) and not np.array_equal(one.observations, other.observations)
    command = ("--profile", "smoke", "--gradient-steps", "6")
    assert move(capsys, "train", str(tmp_path / "A"), str(tmp_path / "policy"), *command)[0] == 0
    code, _, told = move(capsys, "train", str(tmp_path / "B"), str(tmp_path / "policy"), *command)
    assert code == 2 and f"data {one.fingerprint} there, {other.fingerprint} here" in told


@pytest.mark.parametrize("images", [False, True])
def test_a_flipped_bit_anywhere_in_a_data_set_is_refused_or_changes_nothing(tmp_path, images):
    made, attributes = numbers(), {"collection": {"task": "push", "seed": 3}, "note": "ö"}
    if images:
        rng = np.random.default_rng(1)
        made = Demonstrations(rng.integers(256, size=(40, 16, 16, 3), dtype=np.uint8), made.actions, made.episode_ends)
    save(made, tmp_path / "data", attributes)
    assert load(tmp_path / "data")[1] == attributes
    rng, refused = np.random.default_rng(2), 0
    for path in sorted(path for path in (tmp_path / "data").rglob("*") if path.is_file()):
        content = path.read_bytes()
        for place in rng.integers(8 * len(content), size=12):
            flipped = bytearray(content)
            flipped[place // 8] ^= 1 << place % 8
            path.write_bytes(flipped)
            try:
                again, read = load(tmp_path / "data")
                assert again.fingerprint == made.fingerprint and read == attributes, (path, place)
            except BadInput as problem:
                assert "\n" not in str(problem)
                refused += path.parent.name in ("img", "keypoints", "action", "episode_ends") and path.name[0] != "."
        path.write_bytes(content)
    assert refused >= 30


@pytest.mark.parametrize("name", ["collection_digest", "collection"])
def test_a_data_set_without_its_digest_or_its_mark_is_refused(tmp_path, name):
    save(numbers(), tmp_path / "data", {"collection": {"task": "push"}})
    about = tmp_path / "data/.zattrs"
    about.write_text(json.dumps({key: value for key, value in json.loads(about.read_text()).items() if key != name}))
    with pytest.raises(BadInput, match="no digest|does not fit its digest"):
        load(tmp_path / "data")


# checkpoints ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("stopped", [True, False])
@pytest.mark.parametrize("then, now", [("bfloat16", "float32"), ("float32", "bfloat16")])
def test_a_training_does_not_go_on_in_another_precision(tmp_path, monkeypatch, stopped, then, now):
    settings = tiny(4, precision="bfloat16")

    def stop(step: int, total: int, loss: float) -> None:
        if stopped and step == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr("move.learn.train.precision_used", lambda wanted, device: then)
    try:
        train(numbers(), settings, 0, tmp_path, checkpoint_every=2, on_step=stop)
    except KeyboardInterrupt:
        assert stopped
    monkeypatch.setattr("move.learn.train.precision_used", lambda wanted, device: now)
    with pytest.raises(BadInput, match=f"precision used {then} there, {now} here"):
        train(numbers(), settings, 0, tmp_path)


# policies ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    """A copy of the shipped policies; returns the folder of a spec's."""
    shutil.copytree(policies._shipped(SHIPPED[0], LAPTOP).parent, tmp_path / "policies")
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    monkeypatch.setattr(policies.paths, "RUNS", tmp_path / "nothing")
    return lambda spec: tmp_path / "policies" / spec.policy_hash


def flip(path: Path, place: int = -5) -> None:
    content = bytearray(path.read_bytes())
    content[place] ^= 4
    path.write_bytes(content)


def without(path: Path, name: str) -> None:
    path.write_text(json.dumps({key: value for key, value in json.loads(path.read_text()).items() if key != name}))


def of_another(folder: Path) -> None:
    shutil.rmtree(folder)
    other = next(path for path in folder.parent.iterdir() if path.name != folder.name)
    shutil.copytree(other, folder)


TAMPERED = [
    (of_another, "is not the policy of .*policy.json says"),
    (lambda folder: (folder / "policy.json").unlink(), "policy.json says nothing"),
    (lambda folder: without(folder / "policy.json", "sha256"), "is not the policy of"),
    (lambda folder: without(folder / "policy.json", "run"), "policy.json says nothing"),
    (lambda folder: without(folder / "run.json", "digest"), "run.json does not fit its digest"),
    (lambda folder: flip(next(folder.glob("tensors*"))), "tensors-.*does not fit its digest"),
    (lambda folder: flip(folder / "episodes.safetensors"), "episodes.safetensors does not fit its digest"),
    (lambda folder: (folder / "episodes.safetensors").unlink(), "episodes.safetensors does not fit its digest"),
    (lambda folder: (folder / "more.safetensors").write_bytes(b""), "more.safetensors does not fit its digest"),
    (lambda folder: (folder / "policy.json").write_text("[" * 10**5), "policy.json"),
]


@pytest.mark.parametrize("change, reason", TAMPERED)
def test_a_shipped_policy_that_is_not_its_runs_is_refused(shipped, change, reason):
    spec = SHIPPED[0]
    assert policies.trained_policy(spec, LAPTOP) and policies.recorded_episodes(spec, LAPTOP)
    change(shipped(spec))
    for read in (policies.trained_policy, policies.recorded_episodes, policies.acting):
        with refused(reason):
            read(spec, LAPTOP)


@pytest.fixture
def checked(shipped, tmp_path):
    """The row of `move verify --all` on a shipped policy's folder, next to the results of the shipped runs."""
    for spec in SHIPPED:
        shutil.copy(paths.ROOT / "results/laptop" / f"{spec.hash}.json", tmp_path)

    def row(spec: PolicyRun) -> dict:
        rows = {row["file"]: row for row in verify.check_files(tmp_path)}
        assert all(row["same"] for file, row in rows.items() if file != f"policies/{spec.policy_hash}")
        return rows[f"policies/{spec.policy_hash}"]

    return row


@pytest.mark.parametrize("change, reason", TAMPERED)
def test_verify_all_names_a_policy_that_is_not_its_runs(shipped, checked, change, reason):
    spec = SHIPPED[-1]
    assert checked(spec) == {"file": f"policies/{spec.policy_hash}", "same": True, "difference": "none"}
    change(shipped(spec))
    row = checked(spec)
    assert not row["same"] and re.search(reason, row["difference"]) and "\n" not in row["difference"]


def test_verify_all_names_a_policy_without_a_run_and_what_is_no_policy(shipped, checked, tmp_path, capsys):
    spec, result = SHIPPED[0], tmp_path / f"{SHIPPED[0].hash}.json"
    other = spec.model_copy(update={"seed": 9})
    shutil.copytree(shipped(spec), shipped(other))
    seals.seal(other, shipped(other))
    (tmp_path / "policies/notes.txt").write_text("a note")
    code, out, _ = move(capsys, "verify", "--all", "--json")
    found = {row["file"]: row["difference"] for row in json.loads(out) if not row["same"]}
    assert code == 1 and found.keys() == {f"policies/{other.policy_hash}", "policies/notes.txt"}
    assert all("no usable result" in why for why in found.values())
    flip(result)  # the policy of a run whose result is damaged belongs to none
    found = {row["file"] for row in verify.check_files(tmp_path) if not row["same"]}
    assert {result.name, f"policies/{spec.policy_hash}"} <= found


def test_a_policy_under_a_fitting_seal_still_has_to_have_the_runs_settings(shipped):
    spec = SHIPPED[0]
    other = spec.model_copy(update={"training": spec.training.model_copy(update={"learning_rate": 0.1})})
    shutil.copytree(shipped(spec), shipped(other))
    seals.seal(other, shipped(other))
    with pytest.raises(BadInput, match="other settings, seed or task"):
        policies.trained_policy(other, LAPTOP)


# source and versions -------------------------------------------------------------------------------------------------


def clone(folder: Path, file: str = "sim/collect.py", line: str = "# another") -> Path:
    """A copy of this package with one more line in a file."""
    shutil.copytree(Path(package.__file__).parent, folder / "move", ignore=shutil.ignore_patterns("__pycache__"))
    with (folder / "move" / file).open("a") as text:
        text.write(line + "\n")
    return folder


@pytest.mark.parametrize("file, decides", [("sim/motion/adc.py", True), ("learn/diffusion.py", True),
                                           ("study/run.py", True), ("figures/page/captions.py", False)])
def test_the_source_that_decides_a_result_is_all_of_it_and_no_more(tmp_path, file, decides):
    assert (provenance.source(clone(tmp_path, file) / "move") != provenance.source()) == decides


def test_a_new_result_says_which_source_made_it_and_an_old_one_stays_readable(tmp_path):
    spec = control_run(task="push", agent="nothing", episodes=1)
    stored = run.run(spec, tmp_path).provenance
    assert stored["source"] == provenance.source() and len(stored["source"]) == 16
    assert stored["cpu_capability"] and set(provenance.DECIDING) <= set(stored["versions"])
    old = {name: value for name, value in stored.items() if name not in ("source", "cpu_capability")}
    results.store(dataclasses.replace(results.load(spec, tmp_path), provenance=old), tmp_path)
    assert "source" not in results.load(spec, tmp_path).provenance


def test_a_result_of_another_version_of_results_is_neither_read_nor_computed(tmp_path):
    spec = control_run(task="push", agent="nothing", episodes=1)
    newer = spec.model_copy(update={"results_version": 2})
    with pytest.raises(BadInput, match="results_version: 2 given; this source computes 1"):
        run.run(newer, tmp_path)
    results.store(results.Result(**{**vars(run.run(spec, tmp_path)), "spec": newer}), tmp_path)
    with pytest.raises(BadInput, match="results version 2; this source reads 1"):
        results.load(newer, tmp_path)


def test_a_caption_counts_the_runs_of_other_versions(tmp_path):
    specs = [control_run(task="push", agent="nothing", episodes=1, seed=seed) for seed in range(4)]
    made = [run.run(spec, tmp_path) for spec in specs]
    assert "versions" not in captions.numbers(made, 0, "")
    for result, changes in zip(made, ({"mujoco": "3.5.0"}, {"mujoco": "3.5.0", "numpy": "1.0"},
                                      {"torch": result_version(made, "torch").split("+")[0] + "+cu130"}), strict=False):
        result.provenance["versions"] |= changes
    assert ("Other versions than here computed 2 runs with mujoco 3.5.0 and 1 run with numpy 1.0."
            in captions.numbers(made, 0, ""))


def test_a_caption_names_processors_where_cells_were_made_on_different_ones(world_of_two_cells):
    assert captions.processors(world_of_two_cells) == []
    world_of_two_cells[0].provenance["processor"] = "Intel(R) Xeon(R) Processor"
    assert captions.processors(world_of_two_cells) == ["AMD EPYC, 3 runs", "Intel Xeon, 1 run"]
    said = captions.numbers(world_of_two_cells, 0, "")
    assert "different processors: AMD EPYC, 3 runs and Intel Xeon, 1 run." in said
    world_of_two_cells[2].provenance["processor"] = "Intel(R) Xeon(R) Processor"
    assert captions.processors(world_of_two_cells) == [], "one of each in both cells"


@pytest.fixture
def world_of_two_cells():
    specs = [policy_run(load_profile("smoke"), task="push", method=method, seed=seed, timesteps=100)
             for method in ("static", "move") for seed in range(2)]
    return [results.Result(spec, [{"success": True}], None, None, {"train": 1.0}, {"processor": "AMD EPYC"})
            for spec in specs]


def result_version(made, name: str) -> str:
    return made[0].provenance["versions"][name]


# the worker's handshake ----------------------------------------------------------------------------------------------

TWO = [collector_run(load_profile("smoke"), task="push", method="static", attempts=2, seed=seed) for seed in range(2)]


def test_a_worker_of_other_source_is_refused_and_computes_nothing(tmp_path):
    other = clone(tmp_path / "clone", "study/run.py", "def _count_attempts(spec, report, seconds): return []")
    environment = os.environ | {"PYTHONPATH": str(other)}
    with LocalCluster(n_workers=0, protocol="tcp://", dashboard_address=None) as local:
        worker = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_worker", local.scheduler_address, "--nthreads", "1",
             "--no-nanny", "--no-dashboard", "--local-directory", str(tmp_path)], env=environment, cwd=tmp_path,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 120
            while not local.scheduler.workers and time.monotonic() < deadline:
                time.sleep(0.1)
            with refused(f"worker .*source [0-9a-f]{{16}}, not {provenance.source()}"):
                execute.execute(TWO, tmp_path / "results", local.scheduler_address, quiet=True)
        finally:
            worker.terminate()
            worker.wait()
    assert not list((tmp_path / "results").iterdir())


@pytest.mark.parametrize("name, version", [("mujoco", "3.5.0"), ("torch", "1.0"), ("numpy", "1.26.0")])
def test_a_worker_of_other_versions_is_refused_at_once_and_later(tmp_path, monkeypatch, name, version):
    here = provenance.deciding() | {name: version}
    monkeypatch.setattr(cluster.Cluster, "__init__", with_deciding(cluster.Cluster.__init__, here))
    for later in (False, True):
        if later:  # as one that joins while others compute
            monkeypatch.setattr(cluster.Cluster, "refuse_unfit_workers", lambda self: None)
        with two_threads() as address, pytest.raises(BadInput, match=f"worker.*it has {name} .*, not {version};"):
            execute.execute(TWO, tmp_path, address, quiet=True)
    assert not list(tmp_path.iterdir())


def with_deciding(made, deciding):
    def make(self, *arguments):
        made(self, *arguments)
        self.deciding = deciding
    return make


# one folder, one source ----------------------------------------------------------------------------------------------

HOLD = """
import sys
from pathlib import Path
from move.study.execute import only_alike
with only_alike(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def holding(folder: Path, source: Path) -> subprocess.Popen:
    """Another process that writes results into `folder`, of the package under `source`."""
    process = subprocess.Popen([sys.executable, "-c", HOLD, str(folder)], cwd=folder,
                               env=os.environ | {"PYTHONPATH": str(source)}, stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    return process


def test_two_sources_do_not_write_into_one_folder_and_one_source_may_twice(tmp_path):
    folder, other = tmp_path / "results", clone(tmp_path / "clone")
    folder.mkdir()
    stranger = holding(folder, other)
    try:
        with refused(f"process {stranger.pid} of .* is writing to .* another source"):
            execute.execute(TWO, folder, workers=1, quiet=True)
        assert len(list(folder.iterdir())) == 1
    finally:
        stranger.kill()  # and leaves its mark, which counts for nothing
        stranger.wait()
    friend = holding(folder, Path(package.__file__).parent.parent)
    try:
        assert len(execute.execute(TWO, folder, workers=1, quiet=True)[0]) == 2
    finally:
        friend.communicate("")
    assert {path.name for path in folder.iterdir()} == {f"{spec.hash}.json" for spec in TWO}


def test_every_shipped_policy_is_that_of_a_run():
    assert {spec.policy_hash for spec in SHIPPED} == {
        path.name for path in policies._shipped(SHIPPED[0], LAPTOP).parent.iterdir()}
