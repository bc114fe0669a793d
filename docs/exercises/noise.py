"""Solution 3: saved victims and duration by noise, from the table of the campaign."""

import csv
from hashlib import sha256
from statistics import fmean

with open("noise/trials.csv", encoding="utf-8") as file:
    missions = list(csv.DictReader(file))

results = ""
for noise_db in (10, 20, 30):
    rows = [row for row in missions if float(row["voice.noise_db"]) == noise_db]
    victims = fmean(float(row["victims_saved"]) for row in rows)
    time_s = fmean(float(row["time_s"]) for row in rows)
    print(f"{noise_db} dB: {victims:.1f} victims saved in {time_s:.1f} s")
    results += f"{victims:.1f} {time_s:.1f} "
print("check:", sha256(results.encode()).hexdigest()[:8])
