"""The monitor of links, step by step, against the whole series at once."""

from types import SimpleNamespace

import numpy as np

from robotteamsim.mission.monitors import LinkMonitor
from robotteamsim.network import newly_endangered


def test_monitor_of_links_finds_in_each_step_what_is_newly_endangered_in_the_whole_series():
    generator, steps, robots = np.random.default_rng(5), 60, 6
    is_there = generator.random((steps, robots)) < np.where(np.arange(steps) % 20 < 10, 1.0, 0.8)[:, None]
    both = is_there[:, :, None] & is_there[:, None, :] & ~np.eye(robots, dtype=bool)
    upper = np.triu(generator.integers(0, 3, (steps, robots, robots)), 1)
    kinds = np.where(both, upper + upper.swapaxes(1, 2), 0)  # no link, endangered, safe
    hops = np.where(np.eye(robots, dtype=bool) & is_there[:, None, :], 0, -1)
    expected = newly_endangered(kinds > 0, kinds == 1, hops)
    monitor = LinkMonitor(robots)
    for step in range(steps):
        network = SimpleNamespace(
            version=step,
            adjacency=kinds[step] > 0,
            endangered=kinds[step] == 1,
            hop_count=hops[step],
            rssi_dbm=np.full((robots, robots), -70.0),
        )
        found = [(link.first, link.second) for link in monitor.news(network)]
        assert found == [tuple(pair) for pair in np.argwhere(np.triu(expected[step], 1)).tolist()]
        assert monitor.news(network) == []
    assert monitor.num_endangered == np.count_nonzero(expected) // 2 > 20
