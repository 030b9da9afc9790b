"""What a caller writes with types; mypy --strict checks it, and that what is wrong is found."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import posewise


def follow(frame: npt.NDArray[np.uint8]) -> list[posewise.MonitorEvent]:
    tracker = posewise.Tracker(lens=("brown", (0.1,)), intrinsics=(500.0, 500.0, 320.0, 240.0))
    result: posewise.Result = tracker.step(frame, 0, hint=((1.0, 2.0, 30.0, 40.0), 0.0, 0.0))
    if result.state == "tracking" and result.loss == "none":
        print(result.landmarks[30], result.eye_status[0] == "shut")
    if result.state == "lost":  # type: ignore[comparison-overlap]
        print("never")
    road = posewise.Zone.angles((-20, 20), (-15, 15), is_road=True)
    with posewise.Monitor(posewise.MonitorConfig("euro-ncap"), zones=[road]) as monitor:
        monitor.update(tracker, result.timestamp_us)
        monitor.update(posewise.Observation(state="tracking", eye_open=(1.0, 1.0)), 10)
        zone: int | str = monitor.state().zone
        events, overwritten = monitor.events()
        print(zone, overwritten, monitor.state().perclos_60.p80)
    posewise.Monitor("generous")  # type: ignore[arg-type]
    posewise.Tracker(lens=("fish-eye", ()))  # type: ignore[arg-type]
    tracker.step(frame)  # type: ignore[call-arg]
    return [event for event in events if event.kind == "long-glance" and not event.is_cut]


def refused(error: posewise.PosewiseError) -> bool:
    return error.name == "E_TIME" and error.status == -5


def largest(frame: npt.NDArray[np.uint8]) -> posewise.Face | None:
    faces: list[posewise.Face] = posewise.Tracker().detect(frame).faces
    return faces[0] if faces else None


info: posewise.ModelInfo = posewise.model_info("research")
settings: posewise.Config = posewise.default_config()
preset: posewise.MonitorConfig = posewise.MonitorConfig("eu-ddaw", min_known=0.25)
for _, each in posewise.track("drive.mp4"):
    print(each.yaw_deg + settings.smoothing_hz, preset.drowsy_p80_60 * 2, info.terms == "free")
