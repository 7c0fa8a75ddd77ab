"""Runs filterpy's filter on the model of tests/peers/src/model.rs: `filter.py STATES...`. Prints
for each size a line of JSON with the time of a step and the state after a thousand steps."""

import json
import sys
import time

import numpy as np
from filterpy.kalman import KalmanFilter

STEP_S = 0.05
STEPS = 1_000


def model(states):
    kalman = KalmanFilter(dim_x=states, dim_z=2)
    kalman.F = np.eye(states)
    kalman.F[0, 2] = -9.81 * STEP_S
    kalman.F[1, 2] = 20.0 * STEP_S
    noise = [1e-3, 1e-4, 1e-6] + [1e-6] * (states - 3)
    for slow in range(3, states):
        kalman.F[2, slow] = STEP_S
        kalman.F[slow, slow] = 1.0 - 0.01 * slow
    kalman.Q = np.diag(noise)
    kalman.H = np.zeros((2, states))
    kalman.H[0, 0] = kalman.H[1, 1] = 1.0
    kalman.R = np.diag([0.01, 4.0])
    kalman.P = np.eye(states)
    kalman.x = np.zeros(states)
    return kalman


def measurements(step):
    def noise(factor, size):
        return (step * factor % 23 - 11.0) * size

    return np.array([20.0 + noise(7, 0.01), 100.0 + noise(5, 0.2)])


def main():
    for states in map(int, sys.argv[1:]):
        kalman = model(states)
        measured = [measurements(step) for step in range(STEPS)]
        started = time.perf_counter_ns()
        for both in measured:
            kalman.predict()
            kalman.update(both)
        step_ns = (time.perf_counter_ns() - started) / STEPS
        print(json.dumps({"step_ns": step_ns, "state": kalman.x.tolist()}))


main()
