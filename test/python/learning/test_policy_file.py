"""Trained networks as files: what they contain, what they decide, and what is no such file."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from robotteamsim import learning
from robotteamsim.campaign.protocol import SearchProtocol, search_design
from robotteamsim.control import foreign_code, make_controller
from robotteamsim.errors import ScenarioError
from robotteamsim.learning import DiscreteAct, LearningError, Observe, export_policy, parallel_env
from robotteamsim.scenario import dump, from_mapping, load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

NAMING = """
name: mine
plan: garage
robots: {count: 1, start: [4.0, 5.0, 0.0]}
mission: {victims: [{name: one, position: [20.0, 5.0]}]}
control: {algorithm: policy.pt}
"""
SHORT = "mission.time_limit_s=20"
SIZE = 181 + 13 + 2 * 5
HEADER = {
    "observe": "robotteamsim.learning.observe:Observe",
    "act": "robotteamsim.learning.act:Act",
    "every": 5,
    "said": 0,
    "teammates": None,
    "vector": SIZE,
    "numbers": 2,
    "torch": "1",
}


@pytest.fixture
def torch():
    return pytest.importorskip("torch", reason="PyTorch is not installed (0.7 GB, or some GB with CUDA; extra train)")


@pytest.fixture
def net(torch):
    torch.manual_seed(0)
    layers = torch.nn.Linear(SIZE, 64), torch.nn.Tanh(), torch.nn.Dropout(0.5), torch.nn.Linear(64, 2), torch.nn.Tanh()
    return torch.nn.Sequential(*layers)


@pytest.fixture
def policy(net, tmp_path):
    path = tmp_path / "policy.pt"
    export_policy(net, path, "garage_sar")
    return path


class OtherObserve(Observe):
    """Without teammates."""

    def parts_of(self):
        return super().parts_of()[:5]

    def vectors(self, percepts):
        return super().vectors(percepts)[..., : self.space.shape[0]]


def written(path, **changed):
    """Write a file with the settings of a policy, but without a network."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("policy/extra/robotteamsim.json", json.dumps(HEADER | changed))
    return path


def controller(path, *overrides):
    return make_controller(0, resolve(load("garage_sar", [f"control.algorithm={path}", *overrides])))


def driven(path, seed):
    """Return time and true poses at the end of a mission."""
    simulation = Simulation(load("garage_sar", [SHORT, f"control.algorithm={path}", f"run.seed={seed}"]))
    simulation.mission.start()
    record = simulation.step()
    while record.mission.state != "ended":
        record = simulation.step()
    assert set(simulation.controllers.faults) == {""}
    return record.sim_time_ns, record.state.true_pose.tolist()


def test_file_decides_as_the_network_in_evaluation(net, policy, torch):
    drives = controller(policy)
    assert net.training
    assert (drives.every, drives.said, drives.observe, drives.act) == (5, 0, Observe, learning.Act)
    net.eval()
    for vector in np.random.Generator(np.random.PCG64(1)).uniform(-1.0, 1.0, (20, SIZE)).astype(np.float32):
        with torch.inference_mode():
            expected = net(torch.tensor(vector)[None])[0].numpy()
        np.testing.assert_allclose(drives.choose(vector), expected, atol=1e-6)


@pytest.mark.slow
def test_file_drives_as_in_the_environment_and_always_alike(policy, torch):
    env, drives = parallel_env(load("garage_sar", [SHORT])), controller(policy)
    vectors, _ = env.reset(seed=11)
    while env.agents:
        vectors, *_ = env.step({agent: drives.choose(vectors[agent]) for agent in env.agents})
    expected = env.record.sim_time_ns, env.record.state.true_pose.tolist()
    assert driven(policy, 11) == expected
    assert driven(policy, 12) != expected
    threads = torch.get_num_threads()
    torch.set_num_threads(threads + 1)
    try:
        assert driven(policy, 11) == expected
        assert torch.get_num_threads() == threads + 1
    finally:
        torch.set_num_threads(threads)


def test_discrete_actions_are_the_largest_number(torch, tmp_path):
    class Constant(torch.nn.Module):
        def forward(self, vector):
            return torch.tensor([[0.0, 3.0, 1.0, 2.0, 9.0]]) + 0.0 * vector[:, :5]

    path = tmp_path / "discrete.pt2"
    export_policy(Constant(), path, "garage_sar", act=DiscreteAct, every=2)
    assert controller(path).choose(np.zeros(SIZE, np.float32)) == 4
    # A car cannot turn on the spot.
    car = controller(path, "robots.drive={kind: car, wheelbase_m: 0.3, max_steering_rad: 0.6}")
    assert car.choose(np.zeros(SIZE, np.float32)) == 1


def test_own_classes_and_numbers_that_are_said_are_in_the_file(torch, tmp_path):
    path = tmp_path / "own.pt"
    settings = {"observe": OtherObserve, "said": 3, "every": 1, "teammates": 1, "max_cycles": 9}
    export_policy(torch.nn.Sequential(torch.nn.Linear(194, 5), torch.nn.Tanh()), path, "garage_sar", **settings)
    drives = controller(path)
    assert (drives.observe.__name__, drives.said, drives.every, drives.teammates) == ("OtherObserve", 3, 1, 1)
    assert drives.choose(np.zeros(194, np.float32)).shape == (5,)


def test_policy_with_room_for_teammates_drives_teams_of_any_size(torch, tmp_path):
    path = tmp_path / "team.pt"
    export_policy(torch.nn.Linear(SIZE, 2), path, "garage_sar", teammates=2)
    for robots in (1, 3, 8):
        assert controller(path, f"robots.count={robots}").choose(np.zeros(SIZE, np.float32)).shape == (2,)


def test_output_that_is_not_an_action_is_one_line(torch, tmp_path):
    path = tmp_path / "odd.pt"
    linear = torch.nn.Linear(SIZE, 2, bias=False)
    torch.nn.init.ones_(linear.weight)
    export_policy(linear, path, "garage_sar")
    drives = controller(path)
    with pytest.raises(LearningError) as raised:
        drives.choose(np.ones(SIZE, np.float32))
    assert str(raised.value) == f"{path}: output array([204., 204.], dtype=float32); expected numbers within [-1, 1]"
    with pytest.raises(LearningError) as raised:
        drives.choose(np.full(SIZE, 3e38, np.float32))
    assert str(raised.value) == f"{path}: output array([inf, inf], dtype=float32); expected 2 finite numbers"


def test_module_that_cannot_be_a_policy_is_one_line(torch, tmp_path):
    class Random(torch.nn.Module):
        def forward(self, vector):
            return torch.rand(1, 2) + 0.0 * vector[:, :2]

    class Counting(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.register_buffer("count", torch.zeros(1, 2))

        def forward(self, vector):
            self.count += vector[:, :2]
            return 1.0 * self.count

    class Branching(torch.nn.Module):
        def forward(self, vector):
            return vector[:, :2] if vector.sum() > 0 else vector[:, 2:4]

    class Several(torch.nn.Module):
        def forward(self, vector):
            return vector[:, :2], vector[:, 2:4]

    class Infinite(torch.nn.Module):
        def forward(self, vector):
            return 1.0 / (0.0 * vector[:, :2])

    path = tmp_path / "policy.pt"
    for module, line in (
        (torch.nn.Linear(7, 2), rf"module: expected one from {SIZE} numbers, shape \(1, {SIZE}\): .*"),
        (Branching(), rf"module: expected one from {SIZE} numbers, shape \(1, {SIZE}\): .*"),
        (torch.nn.Linear(SIZE, 3), r"module: returns tensor\(\[\[.*; expected a tensor of shape \(1, 2\), finite"),
        (Infinite(), r"module: returns tensor\(\[\[inf, inf\]\]\); expected a tensor of shape \(1, 2\), finite"),
        (Several(), r"module: returns tuple; expected a tensor of shape \(1, 2\), finite"),
        (Random(), "module: returns other numbers the second time; expected one without chance and memory"),
        (Counting(), "module: returns other numbers the second time; expected one without chance and memory"),
        (len, "module: <built-in function len>; expected a torch.nn.Module"),
    ):
        with pytest.raises(LearningError, match=f"^{line}$"):
            export_policy(module, path, "garage_sar")
    with pytest.raises(LearningError, match=r"policy.onnx: expected a name that ends in .pt or .pt2$"):
        export_policy(torch.nn.Linear(SIZE, 2), tmp_path / "policy.onnx", "garage_sar")

    class Local(Observe):
        pass

    with pytest.raises(LearningError, match=r"Local: expected a class of a module that can be imported where"):
        export_policy(torch.nn.Linear(SIZE, 2), path, "garage_sar", observe=Local)
    assert not path.exists()


def test_damaged_file_is_one_line(policy):
    data = bytearray(policy.read_bytes())
    data[data.index(b"weight_0") + 500] ^= 255
    policy.write_bytes(data)
    with pytest.raises(LearningError, match=rf"^{policy}: not a policy, or damaged at \w+/data/weights/\w+; expected"):
        controller(policy)


def test_file_that_is_not_a_network_is_one_line(torch, tmp_path, capfd):
    path = written(tmp_path / "empty.pt")
    with pytest.raises(LearningError, match=f"^{path}: written by PyTorch 1, which [^ ]+ cannot read: [^\n]*$"):
        controller(path)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("changed", "overrides", "line"),
    [
        (
            {},
            ["robots.count=2"],
            f"observations of {SIZE} numbers; expected {SIZE - 5}, those of robot_0 of",
        ),
        ({"numbers": 3}, [], "outputs of 3 numbers; expected 2, those of robot_0 of"),
        (
            {"every": 0},
            [],
            "robotteamsim.json: Expected `int` >= 1 - at `$.every`; expected a policy of",
        ),
        (
            {"teammates": 10**9},
            [],
            "robotteamsim.json: Expected `int` <= 2999 - at `$.teammates`; expected a policy of",
        ),
        (
            {"else": 0},
            [],
            "robotteamsim.json: Object contains unknown field `else`; expected a policy of",
        ),
        (
            {"observe": "robotteamsim.learning:Act"},
            [],
            '"robotteamsim.learning:Act"; expected a class derived from',
        ),
        ({"act": "nobodys:Act"}, [], "\"nobodys:Act\": ModuleNotFoundError: No module named 'nobodys'; is its folder"),
    ],
)
def test_settings_that_do_not_fit_are_one_line(tmp_path, changed, overrides, line):
    path = written(tmp_path / "policy.pt", **changed)
    with pytest.raises(LearningError) as raised:
        controller(path, *overrides)
    assert str(raised.value).startswith(f"{path}: {line}")


def test_package_that_a_class_in_the_file_needs_is_named(tmp_path, monkeypatch):
    (tmp_path / "needing.py").write_text("import torchrl.nowhere\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "torchrl", None)
    path = written(tmp_path / "policy.pt", act="needing:Act")
    line = rf'^{path}: "needing:Act": this needs the Python package torchrl, which is not installed: it comes with the'
    with pytest.raises(LearningError, match=line):
        controller(path)


@pytest.mark.parametrize("content", [b"", b"PK\3\4", b"no archive"])
def test_other_file_is_one_line(tmp_path, content):
    path = tmp_path / "policy.pt"
    path.write_bytes(content)
    with pytest.raises(LearningError) as raised:
        controller(path)
    assert str(raised.value) == f"{path}: not a policy, or damaged at its end; expected a file of export_policy"


def test_file_is_relative_to_the_scenario_and_typed_to_the_folder(tmp_path, monkeypatch):
    (tmp_path / "own").mkdir()
    path = written(tmp_path / "own" / "policy.pt")
    scenario = tmp_path / "own" / "mine.yaml"
    scenario.write_text(NAMING)
    loaded = load(scenario)
    assert loaded.control.algorithm == str(path)
    assert path in loaded.origin.files
    assert from_mapping(loaded.model_dump(by_alias=True, mode="json"), "mission.json").control == loaded.control
    assert str(path) in dump(loaded)
    monkeypatch.chdir(tmp_path)
    assert load("garage_sar", ["control.algorithm=own/policy.pt"]).control.algorithm == str(path)
    with pytest.raises(ScenarioError) as raised:
        load("garage_sar", ["control.algorithm=policy.pt"])
    assert str(raised.value) == "--set: control.algorithm: there is no file 'policy.pt'"
    path.rename(tmp_path / "elsewhere.pt")
    with pytest.raises(ScenarioError) as raised:
        load(scenario)
    assert str(raised.value) == f"{scenario}: control.algorithm: there is no file 'policy.pt'"


def test_file_that_a_scenario_names_runs_code(tmp_path):
    written(tmp_path / "policy.pt")
    scenario = tmp_path / "mine.yaml"
    scenario.write_text(NAMING)
    with pytest.raises(ScenarioError, match=r"policy.pt' runs any code; if you trust the file, add --allow-code$"):
        foreign_code.check_scenario(load(scenario), "--allow-code")
    foreign_code.check_scenario(load("garage_sar", [f"control.algorithm={tmp_path / 'policy.pt'}"]), "--allow-code")


@pytest.mark.slow
def test_without_pytorch_it_is_named(tmp_path):
    path = written(tmp_path / "policy.pt")
    program = (
        "import sys; sys.modules['torch'] = None\n"
        "from robotteamsim.cli import main\n"
        f"sys.exit(main(['run', 'garage_sar', '--quiet', '--set', 'control.algorithm={path}']))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    needs = "this needs the Python package torch, which is not installed: it comes with the extra 'train'"
    assert (done.returncode, done.stderr) == (2, f"robotteamsim: {needs} (docs/learning.md)\n")


@pytest.mark.slow
def test_file_is_an_arm_of_the_benchmark(policy, monkeypatch):
    monkeypatch.chdir(policy.parent)
    design = search_design(SearchProtocol(("random_walk", "policy.pt"), ("garage",), (20.0,), (3,), trials=1))
    assert [cell.values[-1] for cell in design.cells] == ["random_walk", "policy.pt"]
    assert design.cells[1].scenario.control.algorithm == str(policy)
