"""Writes one scene as clouds, arrays and images, with programs that know nothing of objecthood.

Arguments: the folder to write to. It holds depth.npy (uint16, millimetres) and color.npy (uint8, RGB).
"""
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import tifffile
from PIL import Image
from plyfile import PlyData, PlyElement

out = Path(sys.argv[1])
depth, color = np.load(out / "depth.npy"), np.load(out / "color.npy")
height, width = depth.shape
K = np.array([[80.0, 0, 39.5], [0, 80.0, 29.5], [0, 0, 1]])

metres = (depth / 1000.0).astype(np.float32)
v, u = np.mgrid[:height, :width]
z = np.where(depth == 0, np.nan, metres.astype(np.float64))
points = np.zeros(height * width, dtype=[(name, "f4") for name in "xyz"] + [(name, "u1") for name in ("red", "green", "blue")])
points["x"], points["y"], points["z"] = ((u - 39.5) / 80 * z).ravel(), ((v - 29.5) / 80 * z).ravel(), z.ravel()
for k, name in enumerate(("red", "green", "blue")):
    points[name] = color[..., k].ravel()
seen = points[np.isfinite(points["z"])]
faces = np.array([([0, 1, 2],), ([1, 2, 3],)], dtype=[("vertex_indices", "i4", (3,))])
for name, text, order in (("text", True, "="), ("little", False, "<"), ("big", False, ">")):
    elements = [PlyElement.describe(faces, "before"), PlyElement.describe(seen, "vertex"), PlyElement.describe(faces, "face")]
    PlyData(elements, text=text, byte_order=order).write(out / f"{name}.ply")
size = [f"num_cols {width}", f"num_rows {height}"]
PlyData([PlyElement.describe(points, "vertex")], byte_order="<", obj_info=size).write(out / "organized.ply")

np.savez(out / "stored.npz", depth=metres, rgb=color, K=K, segmap=depth)
np.savez_compressed(out / "compressed.npz", depth=depth, rgb=color, K=K.astype(np.float32))
np.savez(out / "no-camera.npz", depth=metres.astype(np.float64))
np.savez_compressed(out / "bomb.npz", depth=np.zeros((4096, 8192), np.float64), K=K)
np.savez(out / "no-depth.npz", K=K)
np.save(out / "metres.npy", metres.astype(">f8"))
np.save(out / "columns.npy", np.asfortranarray(depth))

grid = np.stack([points[name].reshape(height, width) for name in "xyz"], axis=-1)
colored = np.concatenate([grid, color / np.float32(255)], axis=-1)
np.save(out / "grid.npy", grid)
np.save(out / "colored.npy", colored.astype(np.float64))
np.save(out / "list.npy", np.concatenate([grid, color.astype(np.float32)], axis=-1)[depth > 0])
np.savez_compressed(out / "points.npz", points=colored)
np.savez_compressed(out / "points-bomb.npz", points=np.zeros((1 << 25, 3), np.float64))
np.save(out / "whole.npy", depth[depth > 0][:99].reshape(-1, 3))

half = color.astype(np.float16) / 255
for name, compression in (("zip", OpenEXR.ZIP_COMPRESSION), ("piz", OpenEXR.PIZ_COMPRESSION), ("rle", OpenEXR.RLE_COMPRESSION), ("none", OpenEXR.NO_COMPRESSION)):
    header = {"compression": compression, "type": OpenEXR.scanlineimage}
    nothing = np.where(depth == 0, np.float32(1e10), metres)
    OpenEXR.File(header, {"RGB": half, "Z": nothing}).write(str(out / f"{name}.exr"))
OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"Y": metres}).write(str(out / "grey.exr"))
OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"RGB": half}).write(str(out / "color.exr"))
bomb = np.zeros((4096, 8192), np.float32)
OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"Z": bomb}).write(str(out / "bomb.exr"))

Image.fromarray(depth).save(out / "depth.png")
Image.fromarray(depth).save(out / "packed.tif", compression="tiff_adobe_deflate")
tifffile.imwrite(out / "depth.tif", depth)
tifffile.imwrite(out / "tiles.tif", depth, tile=(16, 16), compression="zlib")
tifffile.imwrite(out / "big-endian.tif", depth, byteorder=">", bigtiff=True)
tifffile.imwrite(out / "metres.tif", metres)
tifffile.imwrite(out / "strips.tif", np.where(depth == 0, np.nan, metres).astype(np.float32), rowsperstrip=7, compression="zlib")
Image.fromarray(color).save(out / "color.png")
Image.fromarray(color).save(out / "color.jpg")
Image.fromarray(color).save(out / "color.tif", compression="tiff_lzw")
bomb = Image.fromarray(np.zeros((4096, 8192), np.uint16))
bomb.save(out / "bomb.png")
bomb.save(out / "bomb.tif", compression="tiff_adobe_deflate")
