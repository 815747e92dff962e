"""Why a pixel is what it is, and what the stages made of the frame."""

import objecthood

found = objecthood.discover(objecthood.synthetic("tabletop", 7))
thing = found[0]
left, top, right, bottom = (int(edge) for edge in thing.xyxy)
why = found.explain((left + right) // 2, (top + bottom) // 2)
print(", ".join(why))
for name, image in found.stages.items():
    print(f"{name}: {image.dtype} {image.shape}")
