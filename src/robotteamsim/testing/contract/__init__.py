"""Tests of the contract of worlds, for pytest: what each world does, whichever engine computes it.

Their fixture `world_of` makes a world of `two_rooms.scenario_of`; `readings_of` returns what sensors of its robots
measure. `check_world` runs all of them; tests of worlds behind ROS import a part.
"""
