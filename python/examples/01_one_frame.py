"""One frame: what can be grasped, where it is, what stands on what."""

import objecthood

# Your own: capture = objecthood.open("scene.pcd")[0], or objecthood.read_images("depth.png", "color.png", camera=.., depth_scale=1000)
capture = objecthood.synthetic("tabletop", 7)
found = objecthood.discover(capture.depth, capture.camera, color=capture.color)
for thing in found:
    print(f"object {thing.id}: sure {thing.objectness:.2f}, at {thing.centroid.round(2)} m, {thing.box3d.size.round(2)} m large, on {thing.parents}")
for notice in found.notices:
    print("note:", notice)
found.save(".", "01")
