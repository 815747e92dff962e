// The stages in their order, and the layer that shows what each puts out.

import { Parameter, Settings, Stage } from "./wire";

interface StageInfo {
  stage: Stage;
  title: string;
  layer: string;
}

export const STAGES: StageInfo[] = [
  { stage: "normals", title: "Normals", layer: "normals" },
  { stage: "curvature", title: "Curvature", layer: "normals" },
  { stage: "structure", title: "Tables, floors, walls", layer: "structure" },
  { stage: "superpixels", title: "Superpixels", layer: "superpixels" },
  { stage: "facets", title: "Facets", layer: "facets" },
  { stage: "borders", title: "Borders", layer: "votes" },
  { stage: "shapes", title: "Shapes", layer: "shapes" },
  { stage: "clusters", title: "Things", layer: "clusters" },
  { stage: "support", title: "Support", layer: "clusters" },
  { stage: "hypotheses", title: "Objectness", layer: "objectness" },
  { stage: "objects", title: "Objects", layer: "objects" },
];

/** The first stage that reads a parameter, under this method. */
export function stageOf({ stages }: Parameter, method: Settings["method"]): Stage | null {
  return stages[method === "context" ? 0 : 1];
}
