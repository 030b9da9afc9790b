"""The driver monitor."""

import dataclasses
import math

import numpy as np
import pytest

import posewise
from posewise import Monitor, MonitorConfig, Observation, Zone

OPEN = Observation(
    state="tracking",
    confidence=0.9,
    translation_mm=(0.0, 0.0, 700.0),
    eye_open=(1.0, 1.0),
    jaw_open=0.0,
)
SHUT = dataclasses.replace(OPEN, eye_open=(0.0, 0.0))
FRAME_US = 40_000


def drive(monitor, start_us, *stretches):
    """Shows a monitor stretches of an observation and its seconds; gives the kinds of events."""
    now, kinds = start_us, []
    for seen, seconds in stretches:
        for _ in range(round(seconds * 1e6 / FRAME_US)):
            monitor.update(seen, now)
            kinds += [event.kind for event in monitor.events()[0]]
            now += FRAME_US
    return now, kinds


def test_the_clip_has_four_blinks(clip):
    tracker, monitor = posewise.Tracker(natural_gaze=True), Monitor()
    assert monitor.state().zone == "unknown"
    events = []
    for i, frame in enumerate(clip[0]):
        tracker.step(frame, i * clip[1])
        monitor.update(tracker, i * clip[1])
        events += monitor.events()[0]
    assert [event.kind for event in events] == ["blink"] * 4
    assert events[0].start_us == 450_000 and events[0].duration_us == 100_000
    state = monitor.state()
    assert (state.eyes, state.eyes_reason, state.blinks) == ("open", "none", 4)
    assert 0.8 < state.openness < 1.1 and 0 < state.perclos_60.p80 < 0.1
    # What the tracker saw can be kept, changed and shown again.
    seen = tracker.observation()
    assert seen.state == "tracking" and seen.confidence > 0.9 and seen.camera_assumed is True
    monitor.update(dataclasses.replace(seen, confidence=0.1), 10**7)
    assert monitor.state().eyes_reason == "low-confidence"


def test_closures_become_microsleeps_and_sleep():
    monitor = Monitor()
    now, kinds = drive(monitor, 0, (OPEN, 2), (SHUT, 4), (OPEN, 1))
    assert kinds == ["long-closure", "microsleep", "sleep", "closure-end"]
    # Nobody is there, which is not closed.
    drive(monitor, now, (Observation(), 11))
    state = monitor.state()
    assert (state.eyes, state.eyes_reason, state.degraded) == ("unknown", "no-face", True)
    quick = Monitor(MonitorConfig(microsleep_us=600_000, long_closure_us=400_000))
    assert "microsleep" in drive(quick, 0, (OPEN, 2), (SHUT, 0.8))[1]


def test_zones_are_met():
    road = Zone.angles((-20, 20), (-15, 15), is_road=True)
    side = Zone.angles(yaw_deg=(30, 80), pitch_deg=(-20, 20))
    monitor = Monitor(MonitorConfig(fixed_pose=True), zones=[road, side])
    aside = dataclasses.replace(OPEN, yaw_deg=40.0)
    now, kinds = drive(monitor, 0, (OPEN, 2), (aside, 4))
    state = monitor.state()
    assert (state.zone, state.zone_by, state.zones_us[2]) == (1, "head", 0)
    assert state.zones_us[0] > 10**6 and state.zones_us[1] > 3 * 10**6
    assert kinds == ["long-glance"] and state.away_us > 3 * 10**6
    monitor.update(dataclasses.replace(OPEN, yaw_deg=-60.0), now)
    assert monitor.state().zone == "outside"
    # A screen in front of the driver, then nothing at all.
    monitor.set_zones([Zone.box((-50, -50, -10), (50, 50, 10), grace_us=2**32 - 1)])
    monitor.update(OPEN, now + 1)
    assert monitor.state().zone == 0
    monitor.set_zones([Zone.plane((0, 0, 0), (50, 0, 0), (0, 50, 0))])
    monitor.update(OPEN, now + 2)
    assert monitor.state().zone == 0
    monitor.set_zones([])
    monitor.update(OPEN, now + 3)
    assert monitor.state().zone == "outside"


def test_presets_have_values():
    fast, slow = (MonitorConfig(f"eu-addw-{speed}") for speed in ("fast", "slow"))
    assert (fast.long_glance_us, slow.long_glance_us) == (3_500_000, 6_000_000)
    assert MonitorConfig().preset == "general" and MonitorConfig().fixed_pose is False
    for preset in posewise.PRESETS:
        assert MonitorConfig(preset).preset == preset
        Monitor(MonitorConfig(preset)), Monitor(preset)
    # What is not given is that of the preset, and 0 is 0.
    config = MonitorConfig("eu-addw-slow", zone_margin_deg=0.0)
    assert (config.zone_margin_deg, config.long_glance_us) == (0.0, 6_000_000)
    Monitor(config)
    with pytest.raises(posewise.PosewiseError):
        Monitor(MonitorConfig(gap_us=0))


def test_a_driver_is_remembered():
    first = Monitor()
    drive(first, 0, (OPEN, 100))
    record = first.save()
    assert len(record) == 64 and first.state().natural_is_final
    second = Monitor()
    second.restore(record)
    now, _ = drive(second, 0, (OPEN, 0.2))
    assert second.state().zone == first.state().zone and now > 0
    assert not second.state().natural_is_final
    wrong = bytes([*record[:-1], 1])
    for damaged in (b"", record[:-1], record + b"0", wrong):
        with pytest.raises(posewise.PosewiseError) as fault:
            second.restore(damaged)
        expected = "E_RECORD_CHECKSUM" if damaged == wrong else "E_RECORD_SIZE"
        assert fault.value.name == expected


def test_another_driver_and_another_clock():
    monitor = Monitor()
    now, _ = drive(monitor, 10**9, (OPEN, 1), (SHUT, 0.2), (OPEN, 1))
    assert monitor.state().blinks == 1
    monitor.update(OPEN, 10**9)
    assert [event.kind for event in monitor.events()[0]] == ["clock-back"]
    with pytest.raises(posewise.PosewiseError, match="timestamp") as fault:
        monitor.update(OPEN, 10**9)
    assert (fault.value.name, fault.value.status) == ("E_TIME", -5)
    monitor.forget_driver()
    assert monitor.state().blinks == 0
    monitor.update(OPEN, -(2**63))
    # Events that nobody reads are lost, the oldest first.
    drive_us = 0
    for _ in range(30):
        for seen in (OPEN, SHUT, SHUT, SHUT, OPEN):
            monitor.update(seen, drive_us)
            drive_us += FRAME_US
    events, overwritten = monitor.events()
    assert len(events) == 24 and overwritten > 0


def test_integers_of_monitors_do_not_wrap():
    monitor = Monitor()
    for now in (2**63, -(2**63) - 1, 2**64):
        with pytest.raises(ValueError, match="timestamp_us must be"):
            monitor.update(OPEN, now)
    with pytest.raises(TypeError):
        monitor.update(OPEN, 0.5)
    for field in dataclasses.fields(MonitorConfig):
        if field.name.endswith("_us"):
            for value in (2**32, -1):
                with pytest.raises(ValueError, match=f"{field.name} must be"):
                    Monitor(MonitorConfig(**{field.name: value}))
    for grace_us in (2**32, -1):
        with pytest.raises(ValueError, match="grace_us must be"):
            monitor.set_zones([Zone.angles((-1, 1), (-1, 1), grace_us=grace_us)])
    assert monitor.state().timestamp_us == 0


@pytest.mark.parametrize(
    "config, status",
    [
        (MonitorConfig(gap_us=1), "E_MONITOR_CONFIG"),
        (MonitorConfig(min_confidence=2.0), "E_MONITOR_CONFIG"),
        (MonitorConfig(nod_deg=math.nan), "E_MONITOR_CONFIG"),
        (MonitorConfig(nod_deg=1e300), "E_MONITOR_CONFIG"),
    ],
)
def test_settings_out_of_range_are_refused(config, status):
    with pytest.raises(posewise.PosewiseError) as fault:
        Monitor(config)
    assert fault.value.name == status


def test_words_lists_and_zones_are_checked():
    monitor = Monitor()
    with pytest.raises(ValueError, match="preset is one of general"):
        Monitor("generous")
    with pytest.raises(ValueError, match="preset is one of"):
        MonitorConfig("")
    with pytest.raises(ValueError, match="state is one of searching, tracking, coasting"):
        monitor.update(dataclasses.replace(OPEN, state="lost"), 0)
    with pytest.raises(ValueError, match="eye_open must have 2 numbers"):
        monitor.update(dataclasses.replace(OPEN, eye_open=(1.0,)), 0)
    with pytest.raises(TypeError):
        monitor.update(dataclasses.replace(OPEN, yaw_deg="left"), 0)
    with pytest.raises(ValueError, match="yaw_deg must have 2 numbers"):
        Zone.angles((1, 2, 3), (0, 1))
    with pytest.raises(ValueError, match="half_v_mm must have 3 numbers"):
        Zone.plane((0, 0, 0), (1, 0, 0), (0, 1))
    wrong = [Zone.angles((5, -5), (0, 1)), Zone.angles((0, math.nan), (0, 1))]
    for zones in ([zone] for zone in wrong):
        with pytest.raises(posewise.PosewiseError) as fault:
            monitor.set_zones(zones)
        assert fault.value.name == "E_MONITOR_ZONES"
    with pytest.raises(posewise.PosewiseError, match="more than 8 zones"):
        monitor.set_zones([Zone.angles((-1, 1), (-1, 1))] * 9)
    with pytest.raises(ValueError, match="numbers must have 9 numbers"):
        monitor.set_zones([Zone("box", (0.0,) * 10)])
    # Arrays are lists, too, and what is not finite is unknown.
    monitor.update(dataclasses.replace(OPEN, eye_open=np.full(2, math.nan)), 0)
    assert monitor.state().eyes == "unknown"


def test_what_is_closed_says_so():
    tracker, monitor = posewise.Tracker(), Monitor()
    with tracker, monitor:
        monitor.update(tracker, 0)
    for call in (
        monitor.state,
        monitor.events,
        monitor.forget_driver,
        lambda: monitor.set_zones([]),
        lambda: monitor.update(OPEN, 1),
    ):
        with pytest.raises(ValueError, match="the Monitor is closed"):
            call()
    for call in (tracker.smoothed, tracker.observation, tracker.events, tracker.reset):
        with pytest.raises(ValueError, match="the Tracker is closed"):
            call()
    monitor.close()
    with pytest.raises(TypeError, match="pickled"):
        monitor.__reduce__()
