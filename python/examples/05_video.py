"""A stream: numbers of objects that last. Here the camera does not move and nothing happens."""

import objecthood

scene = objecthood.synthetic("tabletop", 7)
tracker = objecthood.Tracker()
for k in range(5):
    tracked = tracker.update(scene, stamp=k / 30)
    print(k, sorted(thing["track"] for thing in tracked.objects if thing["track"] is not None), tracked.events)
print(tracker.finish())
