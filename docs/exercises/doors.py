"""Solution 2: what two closed fireproof doors cost a link along the corridor."""

from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load

scenario = load("isr_floor_0_sar")
west, east = (20.0, 13.0), (44.0, 13.0)
field = RadioField(scenario.plan, scenario.radio)


def signal_dbm():
    return scenario.radio.tx_power_dbm - field.path_loss_db(west, east)


open_dbm = signal_dbm()
for door in scenario.plan.doors:
    if door.kind == "fireproof":
        field.set_door(door.name, closed=True)
closed_dbm = signal_dbm()
print(f"doors open: {open_dbm:.1f} dBm")
print(f"doors closed: {closed_dbm:.1f} dBm")
print(f"difference: {open_dbm - closed_dbm:.1f} dB")
