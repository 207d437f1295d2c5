"""Write the example of an operator's commands: a hand on a joystick, from a seed.

    python benchmarks/operator_example.py scenarios/data/operator_example.csv

Each joint's speed is low-passed noise (a hand is slower than 1 Hz) that is let go of now and then;
a spring to the middle keeps the arm near its start. 20 s, a row every 50 ms.
"""

import sys
from pathlib import Path

import numpy as np

STEP, SECONDS, SEED = 0.05, 20.0, 560
HAND = 0.35  # time constant of the hand [s]
SPEED = np.array([0.9, 0.35, 0.5])  # rms of the speed asked for [rad/s]
SPRING = np.array([0.12, 0.35, 0.35])  # pull to the start [1/s]
REST = 0.5  # the hand begins after this [s]


def main(path: Path) -> None:
    generator = np.random.default_rng(SEED)
    keep = np.exp(-STEP / HAND)
    angles, speed, stick = np.zeros(3), np.zeros(3), np.zeros(3)
    rows = [(0.0, *angles)]
    held = True
    for k in range(1, round(SECONDS / STEP) + 1):
        if generator.random() < STEP / 2.0:  # every 2 s or so it grasps or lets go
            held = not held
        drive = generator.normal(size=3) * SPEED * np.sqrt((1 + keep) / (1 - keep))
        wanted = drive if held and k * STEP > REST else np.zeros(3)
        stick = keep * stick + (1.0 - keep) * wanted
        speed = keep * speed + (1.0 - keep) * (stick - SPRING * angles)
        angles = angles + STEP * speed
        rows.append((k * STEP, *angles))
    path.parent.mkdir(parents=True, exist_ok=True)
    text = "\n".join(",".join(f"{value:.5f}" for value in row) for row in rows)
    path.write_text(f"t,q1,q2,q3\n{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
