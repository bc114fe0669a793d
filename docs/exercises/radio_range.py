"""Solution 1: how far a link reaches, by hand and by the simulator."""

from hashlib import sha256

from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load

scenario = load("garage_sar")
radio, network = scenario.radio, scenario.network


def reach_m(threshold_dbm, walls_db=0.0):
    """Solve tx power - constant loss - slope * log10(d) - walls = threshold for d."""
    budget_db = radio.tx_power_dbm - threshold_dbm - radio.constant_loss_db - walls_db
    return 10.0 ** (budget_db / radio.slope_db)


endangered_m = reach_m(network.endangered_below_dbm)
lost_m = reach_m(network.lost_below_dbm)
behind_walls_m = reach_m(network.lost_below_dbm, 2 * radio.wall_loss_db[0])
print(f"endangered beyond {endangered_m:.1f} m")
print(f"lost beyond {lost_m:.1f} m, behind two walls of 20 cm beyond {behind_walls_m:.1f} m")

open_ground = scenario.plan.model_copy(update={"walls": (), "blocks": (), "doors": ()})
loss_db = RadioField(open_ground, radio).path_loss_db((0.0, 0.0), (endangered_m, 0.0))
print(f"the simulator: {radio.tx_power_dbm - loss_db:.1f} dBm at {endangered_m:.1f} m")

results = f"{endangered_m:.1f} {lost_m:.1f} {behind_walls_m:.1f}"
print("check:", sha256(results.encode()).hexdigest()[:8])
