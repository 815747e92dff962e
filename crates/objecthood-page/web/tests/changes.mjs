// What the tests change.

/** A parameter of every stage, and another value of it. */
export const CHANGES = {
  normals: ["local_fit.radius_px", 5],
  structure: ["structure.angle_deg", 12],
  superpixels: ["watershed.seed_block_px", 20],
  facets: ["merging.plane_tolerance_quanta", 3],
  borders: ["border.gap_quanta", 1.5],
  shapes: ["contraction.reflex_offset_deg", -10],
  clusters: ["fragments.max_size_px", 900],
  support: ["objectness.min_size_px", 9000],
  hypotheses: ["objectness.max_second_side_m", 0.1],
  objects: ["objectness.threshold", 0.93],
};
