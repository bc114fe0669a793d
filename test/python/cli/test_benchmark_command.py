"""`robotteamsim benchmark`."""

from __future__ import annotations

import contextlib
import csv
import json
import math
from pathlib import Path

import pytest

from robotteamsim import learning
from robotteamsim.campaign import read_store
from robotteamsim.cli import benchmark_command, campaign_command, main

pytestmark = pytest.mark.slow

SEARCH = ("benchmark", "search", "--controller", "greedy", "--controller", "random_walk", "--building", "warehouse")
PATROL = ("benchmark", "patrol", "--robots", "2", "--trials", "2", "--duration", "60")
GRAPH = Path(__file__).parents[2] / "data" / "patrol" / "three.graph"


@pytest.fixture(autouse=True)
def _on_two_workers(two_workers, monkeypatch):
    """Let the command use the workers that are there already."""
    monkeypatch.setattr(campaign_command, "local_workers", lambda count, most: contextlib.nullcontext(two_workers))


def rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def test_search_reports_each_controller_and_a_bound_below_every_time(capsys, tmp_path):
    assert main([*SEARCH, "--trials", "3", "--victims", "2", "--out", str(tmp_path)]) == 0
    captured = capsys.readouterr()
    assert captured.out.endswith(f"\nwritten {tmp_path}/report.html\n")
    assert captured.err.startswith("benchmark search: 6 trials\n")
    bound, *found = rows(tmp_path / "tables" / "search.csv")
    assert bound["controller"] == "clairvoyant (lower bound)"
    assert [row["controller"] for row in found] == ["greedy", "random_walk"]
    assert all(row["place"] == "warehouse, 20 dB, 3 robots" for row in found)
    assert all(float(row["over the bound"]) >= 1.0 for row in found if row["over the bound"] != "-")
    assert float(bound["time to save all [s]"]) > 0.0
    page = (tmp_path / "report.html").read_text()
    assert "Performance profiles" in page
    assert "--controller greedy --controller random_walk --building warehouse" in page
    seeds = {(outcome.number, outcome.seed) for outcome in read_store(tmp_path).outcomes}
    assert len(seeds) == 3


def test_policies_are_arms_besides_the_controllers_with_the_same_seeds(capsys, tmp_path):
    policy = "robotteamsim.control.baselines.random_walk:RandomWalkController"
    assert main([*SEARCH, "--policy", policy, "--trials", "2", "--quiet", "--out", str(tmp_path)]) == 0
    _, greedy, walk, same = rows(tmp_path / "tables" / "search.csv")
    assert [row["controller"] for row in (greedy, walk, same)] == ["greedy", "random_walk", policy]
    assert walk | {"controller": policy} == same
    assert main([*SEARCH, "--policy", "search", "--out", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.endswith("--policy: 'search'; expected a file .pt or .pt2, or module:Class\n")
    assert main([*SEARCH, "--policy", "no.pt", "--out", str(tmp_path / "none")]) == 2
    problem = f"--policy: {Path('no.pt').absolute()}: No such file or directory; expected a policy"
    assert capsys.readouterr().err.endswith(f"{problem}\n")


def test_trained_network_is_an_arm(tmp_path):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed (extra train)")
    path = tmp_path / "policy.pt"
    network = torch.nn.Sequential(torch.nn.Linear(204, 2), torch.nn.Tanh())
    learning.export_policy(network, path, "garage_sar")
    command = [*SEARCH, "--policy", str(path), "--trials", "2", "--quiet", "--out", str(tmp_path / "out")]
    assert main(command) == 0
    assert [row["controller"] for row in rows(tmp_path / "out" / "tables" / "search.csv")][1:] == [
        "greedy",
        "random_walk",
        str(path),
    ]


def test_benchmark_that_is_finished_only_writes_its_report_again(capsys, tmp_path, monkeypatch):
    command = [*SEARCH, "--trials", "2", "--json", "--out", str(tmp_path)]
    assert main(command) == 0
    first, page = json.loads(capsys.readouterr().out), (tmp_path / "report.html").read_bytes()
    monkeypatch.setattr(campaign_command, "local_workers", None)
    assert main(command) == 0
    assert json.loads(capsys.readouterr().out) == first
    assert (tmp_path / "report.html").read_bytes() == page
    (difference,) = (row for row in first["tables"]["differences"] if row["quantity"] == "victims saved")
    assert [difference[key] for key in ("at", "first", "second")] == [
        "warehouse, 20 dB, 3 robots",
        "greedy",
        "random_walk",
    ]
    assert difference["pairs"] == "2"


def test_search_reports_the_floor_covered(tmp_path):
    assert main([*SEARCH, "--quiet", "--out", str(tmp_path)]) == 0
    shares = [json.loads(outcome.details)["coverage"] for outcome in read_store(tmp_path).outcomes]
    found = {row["controller"]: row["floor covered [%]"] for row in rows(tmp_path / "tables" / "search.csv")}
    mean = 100.0 * sum(shares) / len(shares)
    assert found.pop("clairvoyant (lower bound)") == ""
    assert sum(map(float, found.values())) / len(found) == pytest.approx(mean, abs=0.1)


def test_patrol_reports_the_idleness_of_every_vertex(capsys, tmp_path):
    assert main([*PATROL, "--graph", str(GRAPH), "--quiet", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out == ""
    found = rows(tmp_path / "tables" / "idleness.csv")
    assert [row["controller"] for row in found] == ["sebs", "conscientious_reactive"]
    vertices = rows(tmp_path / "tables" / "vertices.csv")
    assert [row["vertex"] for row in vertices] == ["0", "1", "2"] * 2
    for row in found:
        own = [float(v["mean idleness [s]"]) for v in vertices if v["controller"] == row["controller"]]
        assert float(row["mean idleness [s]"]) == pytest.approx(sum(own) / 3, abs=0.11)
        assert 0.0 < float(row["mean idleness [s]"]) < float(row["greatest idleness [s]"]) <= 60.0
    details = [json.loads(outcome.details)["idleness"] for outcome in read_store(tmp_path).outcomes]
    assert all(math.isfinite(one["mean_s"]) for one in details)


def test_mistakes_are_one_line_and_leave_no_folder(refusal, tmp_path):
    folder = tmp_path / "out"
    assert refusal(*SEARCH, "--noise", "90", "--out", folder).startswith("--noise: noise_db: 90.0 is above 80")
    assert refusal("benchmark", "search", "--controller", "no", "--out", folder).startswith("--controller: 'no' is not")
    assert "expected a team" in refusal("benchmark", "patrol", "--building", "warehouse_push", "--out", folder)
    assert not folder.exists()


def test_folder_of_another_benchmark_is_rejected(refusal, tmp_path):
    assert main([*PATROL, "--controller", "sebs", "--quiet", "--out", str(tmp_path)]) == 0
    line = refusal(*PATROL, "--controller", "conscientious_reactive", "--out", tmp_path)
    assert "contains a campaign with" in line


def test_quick_is_the_default_and_full_is_larger():
    assert benchmark_command.protocols.quick_search().trials < benchmark_command.protocols.full_search().trials == 30


def test_exploration_reports_times_and_maps_of_each_controller(tmp_path):
    command = ["benchmark", "exploration", "--building", "corridor", "--robots", "2", "--duration", "90"]
    command += ["--controller", "frontier", "--controller", "rdpso", "--trials", "2", "--out", str(tmp_path)]
    assert main([*command, "--quiet"]) == 0
    frontier, rdpso = rows(tmp_path / "tables" / "exploration.csv")
    assert (frontier["controller"], rdpso["controller"]) == ("frontier", "rdpso")
    assert 10.0 < float(frontier["T_90 median [s]"]) < 90.0
    assert float(frontier["walls within 10 cm [%]"].split()[0]) > 95.0
    assert "--start near --pose unknown" in (tmp_path / "report.html").read_text()
