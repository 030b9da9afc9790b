"""drive.py VIDEO [PRESET] - watches a driver: an event per line, then what was measured.

PRESET is one of posewise.PRESETS. What the numbers mean is in docs/driver-monitor.md.
"""

import sys

import posewise


def zones(car):
    """The road, a mirror that may be looked at for a second, and the screen of the car."""
    road = posewise.Zone.angles(yaw_deg=(-25, 25), pitch_deg=(-12, 15), is_road=True)
    mirror = posewise.Zone.angles(yaw_deg=(35, 60), pitch_deg=(-10, 10), grace_us=1_000_000)
    x, y, z = car["screen_mm"]
    screen = posewise.Zone.box((x - 120, y - 80, z - 20), (x + 120, y + 80, z + 20))
    floor = posewise.Zone.plane((0, 600, 400), (400, 0, 0), (0, 0, 400))
    return [road, mirror, screen, floor]


def main():
    video, *preset = sys.argv[1:]
    # A look into the lap is reported after a second.
    config = posewise.MonitorConfig(*preset, look_down_us=1_000_000)
    # Part of the driver's mean gaze is taken off it: most of the time drivers look ahead.
    tracker = posewise.Tracker(natural_gaze=True)
    with posewise.Monitor(config, zones=zones({"screen_mm": (300, 250, 100)})) as monitor:
        for _, result in posewise.track(video, tracker):
            monitor.update(tracker, result.timestamp_us)
            events, overwritten = monitor.events()
            for event in events:
                end = " cut" if event.is_cut else ""
                seconds = f"{event.start_us / 1e6:.2f} s for {event.duration_us / 1e6:.2f} s"
                print(f"{event.kind} from {seconds}, zone {event.zone}{end}")
            if overwritten:
                print(f"{overwritten} events were not read in time")
        state, seen = monitor.state(), tracker.observation()
        # Somebody else sits down, in another car, and then the driver whose record was kept.
        record = monitor.save()
        monitor.forget_driver()
        monitor.set_zones(zones({"screen_mm": (350, 200, 150)}))
        monitor.restore(record)
    minute = state.perclos_60
    print(f"eyes {state.eyes} ({state.eyes_reason}), {state.drowsiness}, zone {state.zone}")
    print(f"{state.blinks} blinks, {state.yawns} yawns, {state.nods} nods")
    print(f"P80 over 60 s: {100 * minute.p80:.1f} % of the {100 * minute.known:.0f} % known")
    print(f"the lids of the last frame: {seen.eye_open[0]:.2f} and {seen.eye_open[1]:.2f}")


if __name__ == "__main__":
    main()
