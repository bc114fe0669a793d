"""Solution 2: what two closed fireproof doors cost a link along the corridor."""

from hashlib import sha256

from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load

scenario = load("isr_floor_0_sar")
west_m, east_m = (20.0, 13.0), (44.0, 13.0)
field = RadioField(scenario.plan, scenario.radio)


def signal_dbm():
    return scenario.radio.tx_power_dbm - field.path_loss_db(west_m, east_m)


open_dbm = signal_dbm()
for door in scenario.plan.doors:
    if door.kind == "fireproof":
        field.set_door(door.name, closed=True)
closed_dbm = signal_dbm()
print(f"doors open: {open_dbm:.1f} dBm")
print(f"doors closed: {closed_dbm:.1f} dBm")
print(f"difference: {open_dbm - closed_dbm:.1f} dB")
print("check:", sha256(f"{open_dbm:.1f} {closed_dbm:.1f}".encode()).hexdigest()[:8])
