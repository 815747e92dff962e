"""What happened in a clip of `mujoco_clips.py`, read from the recorded states. The definitions are those of docs/VIDEO_TRUTH.md.

Not told, because no clip is made for them: `put_in`, `taken_out`, `split`, `opened`, `merged`.
"""

from dataclasses import dataclass, field

# As in crates/objecthood-scene/src/video/events, which says what each is for.
BRIEF_S, PAUSE_S, SETTLED_S, BOUNCE_S, SEEN_S = 0.1, 0.15, 0.2, 0.34, 0.15
APPEARED_PX, HIDDEN, OPEN, FLIGHT_FRAMES = 10, 0.1, 0.5, 5
LIFTED_M, PICKED_M, PUSHED_M, BEGUN_M, FALL_M = 0.02, 0.005, 0.012, 0.002, 0.03


@dataclass
class Tape:
    """A thing, frame by frame."""

    instance: int
    seen_px: list = field(default_factory=list)  # of an image of 160 x 120
    alone_px: list = field(default_factory=list)  # the same if nothing hid it
    hider: list = field(default_factory=list)  # the instance that is nearest before it most often
    bottom_m: list = field(default_factory=list)  # height of its lowest point
    center_m: list = field(default_factory=list)  # (x, y, z)
    is_moved: list = field(default_factory=list)  # whether the hand touches or holds it
    is_free: list = field(default_factory=list)  # whether only gravity acts on it
    parent: list = field(default_factory=list)  # the instance that holds it from below, 0 the table; None: nothing


def runs(flags, gap=0):
    """First and last frame of every run of true; gaps of so many frames are closed."""
    found = []
    for frame in (k for k, flag in enumerate(flags) if flag):
        if found and frame <= found[-1][1] + gap + 1:
            found[-1][1] = frame
        else:
            found.append([frame, frame])
    return found


def events(tape, frames_per_s, hand):
    """The events of a thing, as `events.jsonl` has them."""
    during = lambda time_s: max(1, round(time_s * frames_per_s))  # noqa: E731

    def event(kind, frame, other=None, start=None, end=None):
        time_s = frame / frames_per_s
        return dict(frame=frame, time=time_s, type=kind, object=tape.instance, other=other, start=start, end=end)

    seen = passages(tape, during, event) + occlusions(tape, during, event)
    return seen + handled(tape, during, event, hand) + flown(tape, during, event)


def passages(tape, during, event):
    """Through the border of the image."""
    found, frames = [], len(tape.alone_px)
    for first, last in runs([px > 0 for px in tape.alone_px], during(BRIEF_S)):
        seen = [k for k in range(first, last + 1) if tape.seen_px[k] >= APPEARED_PX]
        if seen and first > 0:
            found.append(event("appeared", seen[0]))
        if seen and last + 1 < frames:
            found.append(event("left", last + 1))
    return found


def occlusions(tape, during, event):
    share = [seen / max(alone, 1) for seen, alone in zip(tape.seen_px, tape.alone_px)]
    hidden = runs([alone > 0 and part < HIDDEN for part, alone in zip(share, tape.alone_px)])
    is_told = lambda start, end: end + 1 - start >= during(BRIEF_S) and max(share[:start], default=0) >= OPEN  # noqa: E731
    return [event("occluded", start, tape.hider[start], start, end) for start, end in hidden if is_told(start, end)]


def handled(tape, during, event, hand):
    """Picked up, placed, pushed."""
    found, frames = [], len(tape.bottom_m)
    moved_m = lambda a, b: sum((x - y) ** 2 for x, y in zip(tape.center_m[a], tape.center_m[b])) ** 0.5  # noqa: E731
    for first, last in runs(tape.is_moved, during(PAUSE_S)):
        before, touched = max(first - 1, 0), range(first, last + 1)
        after = min(last + during(SETTLED_S), frames - 1)
        rise_m = {k: tape.bottom_m[k] - tape.bottom_m[before] for k in touched}
        if max(rise_m.values()) <= LIFTED_M:
            begun = [k for k in touched if moved_m(before, k) > BEGUN_M]
            if begun and moved_m(before, after) > PUSHED_M:
                found.append(event("pushed", begun[0], hand))
            continue
        picked = next(k for k in touched if rise_m[k] > PICKED_M)
        if tape.parent[before] is not None:
            found.append(event("picked_up", picked, hand))
        placed = next((k for k in range(last, after + 1) if tape.parent[k] is not None), None)
        if placed is None or any(start + 2 >= last and start <= placed for start, _ in flights(tape)):
            continue
        while placed > picked + 1 and tape.parent[placed - 1] is not None:
            placed -= 1
        found.append(event("placed_on", placed, tape.parent[placed]))
    return found


def flights(tape):
    """First and last frame of every flight in the image."""
    flags = [free and alone > 0 for free, alone in zip(tape.is_free, tape.alone_px)]
    return [(start, end) for start, end in runs(flags) if end + 1 - start >= FLIGHT_FRAMES]


def flown(tape, during, event):
    """Airborne, fell, landed."""
    found, all_flights, gap = [], flights(tape), during(BOUNCE_S)
    height_m = [center[2] for center in tape.center_m]
    for k, (start, end) in enumerate(all_flights):
        found.append(event("airborne", start, None, start, end))
        is_first = k == 0 or all_flights[k - 1][1] + gap < start
        since = start - during(SEEN_S)
        was_seen = since >= 0 and min(tape.alone_px[since : start + 1]) > 0
        rises_m = max(height_m[start : end + 1]) - height_m[start]
        if is_first and was_seen and height_m[start] - height_m[end] > FALL_M and rises_m < FALL_M:
            found.append(event("fell", start))
        is_last = k + 1 == len(all_flights) or end + gap < all_flights[k + 1][0]
        if is_last and end + 1 < len(height_m) and tape.alone_px[end + 1] > 0:
            found.append(event("landed", end + 1))
    return found
