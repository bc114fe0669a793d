"""Standard functions of many points, shape (n, dimensions), all with minimum 0; for tests and the benchmark."""

import numpy as np


def sphere(x):
    return np.sum(x * x, axis=1)


def rosenbrock(x):
    """Has its minimum at (1, ..., 1), along a bent valley."""
    return np.sum(100.0 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1.0 - x[:, :-1]) ** 2, axis=1)


def rastrigin(x):
    return np.sum(x * x - 10.0 * np.cos(2.0 * np.pi * x) + 10.0, axis=1)


def griewank(x):
    roots = np.sqrt(np.arange(1.0, x.shape[1] + 1.0))
    return np.sum(x * x, axis=1) / 4000.0 - np.prod(np.cos(x / roots), axis=1) + 1.0


def ackley(x):
    spread = 20.0 * np.exp(-0.2 * np.sqrt(np.mean(x * x, axis=1)))
    return 20.0 - spread + np.e - np.exp(np.mean(np.cos(2.0 * np.pi * x), axis=1))


def schaffer(x):
    """F6 in two dimensions, summed over neighbouring pairs in more."""
    r2 = x[:, 1:] ** 2 + x[:, :-1] ** 2
    return np.sum(0.5 + (np.sin(np.sqrt(r2)) ** 2 - 0.5) / (1.0 + 0.001 * r2) ** 2, axis=1)
