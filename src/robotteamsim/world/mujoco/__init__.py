"""The world of MuJoCo: bodies in three dimensions, with wheels, friction and rays. An extra, `robotteamsim[mujoco]`."""
