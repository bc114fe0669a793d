import numpy as np
import pytest

from robotteamsim.swarm.objective import Objective, UndefinedValue

PLACES = np.array([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]])


def test_values_are_the_same_one_by_one_and_all_at_once():
    one_by_one = Objective(lambda x: float(np.sum(x)), vectorized=False, sign=-1.0)
    at_once = Objective(lambda x: np.sum(x, axis=1), vectorized=True, sign=-1.0)
    assert one_by_one(PLACES).tolist() == at_once(PLACES).tolist() == [-1.0, -5.0, -9.0]
    assert one_by_one.nfev == at_once.nfev == 3


def test_objective_that_writes_into_its_argument_moves_no_particle():
    places = PLACES.copy()

    def greedy(x):
        x += 1.0
        return float(np.sum(x))

    Objective(greedy, vectorized=False, sign=1.0)(places)
    assert places.tolist() == PLACES.tolist()


def test_objective_that_raises_is_named_with_its_particle_and_keeps_its_cause():
    objective = Objective(lambda x: 1.0 / (float(x[0]) - 2.0), vectorized=False, sign=1.0)
    with pytest.raises(ValueError, match=r"raised ZeroDivisionError for particle 1 at \[2.0, 3.0\]: ") as caught:
        objective(PLACES)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.parametrize(
    ("answer", "vectorized", "message"),
    [
        ([1.0, 2.0], False, r"one number for particle 0 at \[0.0, 1.0\], got shape \(2,\)"),
        ("far", False, r"numbers for particle 0 at \[0.0, 1.0\], got 'far'"),
        (np.zeros((3, 1)), True, r"shape \(3,\) for 3 particles at once, got \(3, 1\)"),
        (1.0, True, r"shape \(3,\) for 3 particles at once, got \(\)"),
    ],
)
def test_wrong_answers_are_refused(answer, vectorized, message):
    objective = Objective(lambda _: answer, vectorized=vectorized, sign=1.0)
    with pytest.raises(ValueError, match=message):
        objective(PLACES)


def test_nan_is_named_with_its_particle():
    objective = Objective(lambda x: np.where(x[:, 0] > 3.0, np.nan, 0.0), vectorized=True, sign=1.0)
    with pytest.raises(UndefinedValue, match=r"nan for particle 2 at \[4.0, 5.0\]"):
        objective(PLACES)


def test_none_counts_as_nan():
    with pytest.raises(UndefinedValue, match=r"nan for particle 0 at \[0.0, 1.0\]"):
        Objective(lambda _: None, vectorized=False, sign=1.0)(PLACES)
