"""Every parameter, with meaning, unit, range and default. Made by generate_params.py; do not edit."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Any

from objecthood import _native
from objecthood.errors import ParameterError


@dataclass(slots=True)
class Sensor:
    """The group `sensor`."""

    disparity_quantum_per_m: float = 0.00285
    """Step of inverse depth that the sensor resolves: the unit of disparity in eq. 1. Unit: 1/m. Range:
    0.000001 ..= 1. Default: 0.00285 (measured on mOSD learn, a Kinect v1; 1/348 by its disparity law
    (docs/CONTEXT.md 0.2))."""

    lateral_noise_px: float = 0.8
    """Sideways noise of points, which looks like noise of disparity on slopes (`context`). Unit: px at a
    focal length of 525 px. Range: 0 ..= 100. Default: 0.8 (tuned on mOSD learn (docs/CONTEXT.md 1.2))."""

    noise: str = "estimated"
    """Source of the noise that tolerances follow (`context`): estimated from each frame, or given by the
    quantum alone, as a Kinect's. Unit: dimensionless: switch. Range: estimated | given. Default: estimated
    (ours, because no constant fits every sensor (docs/CONTEXT.md 0.5))."""

    profile: str = "none"
    """Kind of the sensor (`context`): its noise counts where a frame tells little of its own. `--profile`
    also sets `sensor.lateral_noise_px`. Unit: dimensionless: switch. Range: none | kinect | stereo | tof |
    phone. Default: none (ours, because a frame mostly tells it better (docs/CONTEXT.md 0.6))."""

    color: str = "all"
    """Stages that ask colour, if there is any (`context`). Unit: dimensionless: switch. Range: all | facets |
    none. Default: all (ours, because colour tells where depth does not (docs/CONTEXT.md))."""


@dataclass(slots=True)
class Smoothing:
    """The group `smoothing`."""

    sigma_px: float = 0.5
    """Standard deviation of the Gaussian; 0 = none. Unit: px. Range: 0 ..= 10. Default: 0.5 (paper, III-A)."""


@dataclass(slots=True)
class Normals:
    """The group `normals`."""

    window_px: float = 10.0
    """Side of the window over which tangents are averaged; it shrinks near depth changes. Unit: px. Range: 2
    ..= 200. Default: 10 (tuned on mOSD learn (PARITY.md 7))."""

    depth_change_per_m: float = 0.02
    """There is a depth change between neighbours whose depths differ by more than this times z^2. Unit: 1/m.
    Range: 0.00001 ..= 10. Default: 0.02 (tuned on mOSD learn (PARITY.md 7))."""


@dataclass(slots=True)
class Curvature:
    """The group `curvature`."""

    enabled: bool = True
    """Whether high curvature bounds superpixels (the paper's comparison). Unit: dimensionless: switch. Range:
    true | false. Default: true (paper, IV)."""

    threshold: float = 0.14
    """Curvature above which a pixel is a border. Unit: dimensionless: 1 - mean cosine of opposite normals.
    Range: 0 ..= 2. Default: 0.14 (paper, III-A)."""

    offset_px: int = 2
    """Distance of the neighbours whose normals are compared. Unit: px. Range: 1 ..= 50. Default: 2 (paper,
    III-A (gamma))."""

    scale: float = 1.0
    """Divides the sum of cosines: greater = more is curved. Unit: dimensionless: sigma of eq. 2. Range: 0.1
    ..= 10. Default: 1 (tuned on mOSD learn (PARITY.md 1); the paper gives no formula)."""


@dataclass(slots=True)
class Graph:
    """The group `graph`."""

    channels: str = "both"
    """The terms of the edge weights. Unit: dimensionless: switch. Range: color | depth | both. Default: both
    (paper, IV)."""

    color_weight: float = 0.5
    """Weight of colour against disparity (alpha). Unit: dimensionless: share. Range: 0 ..= 1. Default: 0.5
    (paper, III-A (alpha))."""

    size_preference_grey: float = 100.0
    """Preference for large components: the step a component of one pixel tolerates (k). Unit: grey levels.
    Range: 0 ..= 1000000. Default: 100 (paper, III-A (k))."""

    min_size_px: int = 100
    """Smaller components are merged with a neighbour (n). Unit: px. Range: 0 ..= 1000000. Default: 100
    (paper, III-A (n))."""


@dataclass(slots=True)
class Absorption:
    """The group `absorption`."""

    depth_gate_per_m: float = 0.02
    """No path crosses a step in depth of more than this times z^2. Unit: 1/m. Range: 0 ..= 10. Default: 0.02
    (tuned on mOSD learn (PARITY.md 7))."""


@dataclass(slots=True)
class Appearance:
    """The group `appearance`."""

    color_weight: float = 0.5
    """Weight of the colour histogram against the histogram of normals (omega). Unit: dimensionless: share.
    Range: 0 ..= 1. Default: 0.5 (paper, III-B (omega))."""

    lab_bins: int = 8
    """Bins per axis of the joint Lab histogram. Unit: bins. Range: 1 ..= 32. Default: 8 (tuned on mOSD learn
    (PARITY.md 7))."""

    inclination_bins: int = 8
    """Bins of the inclination of the normals, over [0, pi]. Unit: bins. Range: 1 ..= 180. Default: 8 (tuned
    on mOSD learn (PARITY.md 7))."""

    azimuth_bins: int = 16
    """Bins of the azimuth of the normals, over [-pi, pi]. Unit: bins. Range: 1 ..= 360. Default: 16 (tuned on
    mOSD learn (PARITY.md 7))."""


@dataclass(slots=True)
class Grouping:
    """The group `grouping`."""

    initial_variation: float = 0.4
    """Internal variation of a single superpixel: the difference in appearance it tolerates (c). Unit:
    dimensionless: histogram distance. Range: 0 ..= 1. Default: 0.4 (tuned on mOSD learn (PARITY.md 3))."""


@dataclass(slots=True)
class Contact:
    """The group `contact`."""

    reach_px: int = 4
    """Largest distance in the image to the neighbouring region, across pixels that belong to no region. Unit:
    px; in `context` at a focal length of 525 px. Range: 1 ..= 100. Default: 4 (tuned on mOSD learn (PARITY.md
    7))."""

    distance_m: float = 0.02
    """Points nearer than this are in contact. Unit: m. Range: 0 ..= 1. Default: 0.02 (tuned on mOSD learn
    (PARITY.md 7))."""


@dataclass(slots=True)
class Gravity:
    """The group `gravity`."""

    up_from: str = "plane"
    """Source of the direction. Unit: dimensionless: switch. Range: plane | camera. Default: plane (ours,
    because the paper's horizontal camera costs a third of the objects on mOSD learn (PARITY.md, Equations))."""

    tilt_deg: float = 0.0
    """Angle by which the camera looks down from the horizon. Unit: degrees. Range: -90 ..= 90. Default: 0
    (paper, III-D: the camera is held horizontally)."""

    roll_deg: float = 0.0
    """Angle by which the camera is turned clockwise about its optical axis. Unit: degrees. Range: -180 ..=
    180. Default: 0 (paper, III-D: the camera is held horizontally)."""

    inlier_distance_m: float = 0.008
    """Points nearer to the plane than this belong to it. Unit: m. Range: 0.0001 ..= 1. Default: 0.008 (tuned
    on mOSD learn (PARITY.md 5))."""

    min_inlier_share: float = 0.1
    """A plane that holds a smaller share of the valid points is no ground to stand on. Unit: dimensionless:
    share of valid points. Range: 0 ..= 1. Default: 0.1 (ours, because a scene without a plane has no up to
    read off)."""

    samples: int = 6000
    """Points sampled in the search for the plane. Unit: points. Range: 3 ..= 1000000. Default: 6000 (ours,
    because more changes no plane (PARITY.md 5))."""

    trials: int = 300
    """Planes tried. Unit: planes. Range: 1 ..= 100000. Default: 300 (ours, because more changes no plane
    (PARITY.md 5))."""


@dataclass(slots=True)
class LocalFit:
    """The group `local_fit`."""

    radius_px: int = 3
    """Half the side of the window, without its middle pixel; at most 199 px of the image. Unit: px at a focal
    length of 525 px. Range: 1 ..= 50. Default: 3 (docs/CONTEXT.md 0.3)."""

    own_window_residual_quanta: float = 0.8
    """A pixel keeps its own window when the residual is below this; otherwise it takes the best of nine
    windows. Unit: quanta of disparity. Range: 0 ..= 1000. Default: 0.8 (docs/CONTEXT.md 0.4: a short cut that
    saves time)."""


@dataclass(slots=True)
class Structure:
    """The group `structure`."""

    tolerance_quanta: float = 2.5
    """Pixels nearer than this to the surface belong to it, if they have its tilt. Unit: quanta of disparity.
    Range: 0 ..= 1000. Default: 2.5 (tuned on mOSD learn (docs/CONTEXT.md 1.1))."""

    angle_deg: float = 30.0
    """A pixel has the tilt of the surface when their normals differ by less than this. Unit: degrees. Range:
    0 ..= 180. Default: 30 (tuned on mOSD learn (docs/CONTEXT.md 1.1))."""

    slope_quanta_per_px: float = 0.4
    """A pixel also has the tilt of the surface when the slopes of their disparities differ by less than this;
    0 = only the normals decide. Unit: quanta of disparity per px at a focal length of 525 px. Range: 0 ..=
    1000. Default: 0.4 (ours, because noise tilts a slope alike at any distance, a normal by more the farther
    it is; 30 degrees at 1 m)."""

    skirt_reach_px: int = 10
    """A skirt of the surface reaches at most this far, twice as far where depth is smeared; 0 = skirts are
    not looked for. Unit: px at a focal length of 525 px. Range: 0 ..= 100. Default: 10 (ours, because it is
    half of a matching window, and the error of registering colour with depth (docs/CONTEXT.md 1.1))."""


@dataclass(slots=True)
class Watershed:
    """The group `watershed`."""

    seed_block_px: int = 8
    """Side of the blocks. Each block has one seed. Unit: px at a focal length of 525 px. Range: 1 ..= 1000.
    Default: 8 (tuned on mOSD learn (docs/CONTEXT.md 1.2))."""

    link_jump_quanta: float = 5.0
    """Largest difference between neighbouring pixels of one surface, beyond the difference that its slope
    explains. Unit: quanta of disparity. Range: 0 ..= 1000. Default: 5 (tuned on mOSD learn (docs/CONTEXT.md
    1.2))."""


@dataclass(slots=True)
class Merging:
    """The group `merging`."""

    plane_tolerance_quanta: float = 1.2
    """Disagreement up to which planes are merged. Unit: quanta of disparity. Range: 0 ..= 1000. Default: 1.2
    (tuned on mOSD learn (docs/CONTEXT.md 2.1))."""

    quadratic_tolerance_quanta: float = 1.5
    """Disagreement up to which quadratics are merged afterwards; 0 = planes only. Unit: quanta of disparity.
    Range: 0 ..= 1000. Default: 1.5 (tuned on mOSD learn (docs/CONTEXT.md 2.1))."""

    min_facet_px: int = 25
    """Smaller facets are dropped; their pixels go to neighbouring facets. Unit: px at a focal length of 525
    px. Range: 0 ..= 1000000. Default: 25 (tuned on mOSD learn (docs/CONTEXT.md 2.1))."""


@dataclass(slots=True)
class Refinement:
    """The group `refinement`."""

    agreement_quanta: float = 0.35
    """Misfit that one neighbour in the same facet outweighs. Unit: quanta of disparity. Range: 0 ..= 1000.
    Default: 0.35 (tuned on mOSD learn (docs/CONTEXT.md 2.2))."""


@dataclass(slots=True)
class ColorCuts:
    """The group `color_cuts`."""

    enabled: bool = True
    """Whether they are cut. Unit: dimensionless: switch. Range: true | false. Default: true (docs/CONTEXT.md
    2.3)."""

    least_against: float = 0.4
    """Least vote of the border between two parts against one thing. Unit: dimensionless: vote per metre of
    border. Range: 0 ..= 1. Default: 0.4 (ours, because noise makes gentle valleys, and this is one of 18
    degrees (docs/CONTEXT.md 2.3))."""


@dataclass(slots=True)
class Flat:
    """The group `flat`."""

    enabled: bool = True
    """Whether they are looked for. Unit: dimensionless: switch. Range: true | false. Default: true
    (docs/CONTEXT.md 2.4)."""

    color_overlap: float = 0.35
    """Greatest overlap of the colours of a flat thing with those of the ring around it, where depth proves
    nothing. Unit: dimensionless: share in common. Range: 0 ..= 1. Default: 0.35 (ours, because 99 % of empty
    patches have 0.45 or more (docs/CONTEXT.md 2.4))."""

    offset_sigmas: float = 5.0
    """A rise above the ring is proof from this many times the disagreement of blocks of an empty surface on.
    Unit: dimensionless: multiples of the noise of docs/CONTEXT.md 0.5. Range: 0 ..= 1000. Default: 5 (ours,
    because empty patches of a Kinect reach four (docs/CONTEXT.md 2.4))."""


@dataclass(slots=True)
class Border:
    """The group `border`."""

    radius_px: int = 7
    """Half the side of the window, without its middle pixel. In the window a plane is fitted to each side of
    the border. Unit: px at a focal length of 525 px. Range: 1 ..= 100. Default: 7 (tuned on mOSD learn
    (docs/CONTEXT.md 3.1))."""

    gap_quanta: float = 4.0
    """A larger gap between the two sides is a step. Unit: quanta of disparity. Range: 0 ..= 1000. Default: 4
    (tuned on mOSD learn (docs/CONTEXT.md 3.1))."""

    step_depth_m: float = 0.013
    """A deeper step hides something; a smaller one may be a torn ridge. Unit: m. Range: 0 ..= 10. Default:
    0.013 (tuned on mOSD learn (docs/CONTEXT.md 3.1))."""


@dataclass(slots=True)
class Contraction:
    """The group `contraction`."""

    reflex_offset_deg: float = 12.0
    """Concavity at which a fold votes neither for one shape nor against it. Unit: degrees. Range: -180 ..=
    180. Default: 12 (tuned on mOSD learn (docs/CONTEXT.md 3.2))."""

    full_vote_deg: float = 15.0
    """Angle between no vote and a full vote. Unit: degrees. Range: 0.001 ..= 360. Default: 15 (tuned on mOSD
    learn (docs/CONTEXT.md 3.2))."""

    occlusion_weight: float = 0.15
    """Vote of a step against one shape. Unit: dimensionless: vote per metre of step. Range: 0 ..= 100.
    Default: 0.15 (tuned on mOSD learn (docs/CONTEXT.md 3.2))."""

    seam_weight: float = 2.0
    """Vote of a seam of colour against one shape. Unit: dimensionless: vote per metre of seam. Range: 0 ..=
    100. Default: 2 (ours, because it has to outvote a flat border as clearly as a valley does
    (docs/CONTEXT.md 3.4))."""

    color_change_weight: float = 0.4
    """What a fold between facets of different colours votes against one shape, besides its angle. Unit:
    dimensionless: vote per metre of fold. Range: 0 ..= 100. Default: 0.4 (ours, because with half the vote of
    a flat border a valley of 6 degrees parts two colours, and a flat border does not (docs/CONTEXT.md 3.2))."""


@dataclass(slots=True)
class Seams:
    """The group `seams`."""

    enabled: bool = True
    """Whether colour parts flush things. Unit: dimensionless: switch. Range: true | false. Default: true
    (docs/CONTEXT.md 3.4)."""

    cross_share: float = 0.7
    """Least share of a section of the body where colour changes. Unit: dimensionless: share of the section.
    Range: 0 ..= 1. Default: 0.7 (ours, because print ends within a face (docs/CONTEXT.md 3.4))."""

    color_overlap: float = 0.12
    """Greatest overlap of the colours of both sides. Unit: dimensionless: share in common. Range: 0 ..= 1.
    Default: 0.12 (ours, because print comes back on the other side (docs/CONTEXT.md 3.4))."""


@dataclass(slots=True)
class Fragments:
    """The group `fragments`."""

    max_size_px: int = 250
    """Clusters with fewer pixels are given away. Unit: px at a focal length of 525 px. Range: 0 ..= 1000000.
    Default: 250 (tuned on mOSD learn (docs/CONTEXT.md 4.2))."""


@dataclass(slots=True)
class Height:
    """The group `height`."""

    min_top_m: float = 0.01
    """Lowest top of an object. Unit: m. Range: -1 ..= 10. Default: 0.01 (tuned on mOSD learn (docs/CONTEXT.md
    4.3))."""


@dataclass(slots=True)
class Vessels:
    """The group `vessels`."""

    concavity: float = 0.2
    """Concavity of a vessel's inside; 0 = vessels are not joined. Unit: dimensionless: mean turn of normals
    towards each other. Range: 0 ..= 2. Default: 0.2 (tuned on mOSD learn (docs/CONTEXT.md 4.4))."""

    rim_height_m: float = 0.015
    """The tops of inside and wall differ in height by at most this. Unit: m. Range: 0 ..= 1. Default: 0.015
    (tuned on mOSD learn (docs/CONTEXT.md 4.4))."""

    rim_circle: bool = True
    """Whether the circle of the rim decides which parts belong to a vessel. Unit: dimensionless: switch.
    Range: true | false. Default: true (docs/CONTEXT.md 4.4.2)."""

    bottom_contact_share: float = 0.8
    """Background, or a flat cluster, that an object encloses is its bottom when at least this share of its
    border touches without a step; above 1 = never. Unit: dimensionless: share of the border. Range: 0 ..= 2.
    Default: 0.8 (ours, because a plate came out as a ring; the far half of a ring's border touches)."""


@dataclass(slots=True)
class Necks:
    """The group `necks`."""

    enabled: bool = True
    """Whether such parts are joined. Unit: dimensionless: switch. Range: true | false. Default: true
    (docs/CONTEXT.md 4.7)."""

    color_overlap: float = 0.55
    """Least overlap of their colour histograms. Unit: dimensionless: share in common. Range: 0 ..= 1.
    Default: 0.55 (ours, because parts of one body share colours (docs/CONTEXT.md 4.7))."""


@dataclass(slots=True)
class Occlusion:
    """The group `occlusion`."""

    enabled: bool = True
    """Whether such parts are joined. Unit: dimensionless: switch. Range: true | false. Default: true
    (docs/CONTEXT.md 4.6)."""

    disagreement_quanta: float = 1.0
    """Disagreement up to which both parts lie on one surface. Unit: quanta of disparity. Range: 0 ..= 1000.
    Default: 1 (tuned on mOSD learn (docs/CONTEXT.md 4.6))."""

    angle_deg: float = 7.0
    """Largest angle between the surfaces of both parts. Unit: degrees. Range: 0 ..= 180. Default: 7 (tuned on
    mOSD learn (docs/CONTEXT.md 4.6))."""

    color_overlap: float = 0.08
    """Least overlap of their colour histograms. Unit: dimensionless: share in common; -1 = colour has no say.
    Range: -1 ..= 1. Default: 0.08 (tuned on mOSD learn (docs/CONTEXT.md 4.6))."""

    max_distance_m: float = 0.35
    """Largest distance between the parts. Unit: m. Range: 0 ..= 100. Default: 0.35 (tuned on mOSD learn
    (docs/CONTEXT.md 4.6))."""


@dataclass(slots=True)
class Objectness:
    """The group `objectness`."""

    min_side_m: float = 0.02
    """Least length of an object's longest side. Unit: m. Range: 0 ..= 100. Default: 0.02 (tuned on mOSD learn
    (PARITY.md 7))."""

    min_second_side_m: float = 0.02
    """Least length of a graspable object's second-longest side; in objectness a soft limit. Unit: m. Range:
    0.001 ..= 100. Default: 0.02 (ours, because what is thinner in two directions is a sliver of something;
    the paper's 2 cm)."""

    max_side_m: float = 0.6
    """Greatest length of an object's longest side; in objectness a soft limit. Unit: m. Range: 0.001 ..= 100.
    Default: 0.6 (tuned on mOSD learn (PARITY.md 7))."""

    max_second_side_m: float = 0.35
    """Greatest length of a graspable object's second-longest side; in objectness a soft limit. Unit: m.
    Range: 0.001 ..= 100. Default: 0.35 (ours, because what is larger in two directions is furniture, and no
    hand spans it (docs/EVALUATION.md))."""

    min_size_px: int = 200
    """Least number of pixels with depth of an object. Unit: px; in `context` at a focal length of 525 px.
    Range: 1 ..= 100000000. Default: 200 (tuned on mOSD learn (PARITY.md 7))."""

    min_p_o: float = 0.7
    """Least P(O) of an object. Unit: dimensionless: probability. Range: 0 ..= 1. Default: 0.7 (tuned on mOSD
    learn (PARITY.md 7))."""

    size_weight: float = 1.0
    """Share that objectness loses when the size is not graspable. Unit: dimensionless: share. Range: 0 ..= 1.
    Default: 1 (ours, because what is too large cannot be moved, whatever else it is)."""

    support_weight: float = 0.3
    """Share that objectness loses when nothing carries the object. Unit: dimensionless: share. Range: 0 ..=
    1. Default: 0.3 (ours, because what carries it may be hidden; alone it refuses nothing)."""

    footing_weight: float = 0.5
    """Share that objectness loses when the object is seen to hang in the air. Unit: dimensionless: share.
    Range: 0 ..= 1. Default: 0.5 (ours, because people, arms and furniture come in pieces that hang in the air
    (docs/EVALUATION.md))."""

    compactness_weight: float = 0.3
    """Share that objectness loses when the object fills nothing of its hull. Unit: dimensionless: share.
    Range: 0 ..= 1. Default: 0.3 (ours, because handles and rings are no less things; alone it refuses
    nothing)."""

    separation_weight: float = 1.0
    """Share that objectness loses when no border of the object is clear. Unit: dimensionless: share. Range: 0
    ..= 1. Default: 1 (ours, because what has no border of its own is a part of something)."""

    visibility_weight: float = 0.1
    """Share that objectness loses when nothing of the outline is the object's own. Unit: dimensionless:
    share. Range: 0 ..= 1. Default: 0.1 (ours, because what is half hidden is there all the same)."""

    threshold: float = 0.55
    """Least objectness of an object. Unit: dimensionless: objectness. Range: 0 ..= 1. Default: 0.55 (ours,
    because it costs no correct object of mOSD learn nor of scenes composed of it (docs/EVALUATION.md))."""

    every_hypothesis: bool = False
    """Whether rejected hypotheses are written as well (`--all`). Unit: dimensionless: switch. Range: true |
    false. Default: false (ours, because the score tells more than a verdict)."""


@dataclass(slots=True)
class Params:
    """All parameters, a group for each algorithm. `Params()` is the method `context`."""

    method: str = "context"
    """The method: context | paper."""
    sensor: Sensor = field(default_factory=Sensor)
    smoothing: Smoothing = field(default_factory=Smoothing)
    normals: Normals = field(default_factory=Normals)
    curvature: Curvature = field(default_factory=Curvature)
    graph: Graph = field(default_factory=Graph)
    absorption: Absorption = field(default_factory=Absorption)
    appearance: Appearance = field(default_factory=Appearance)
    grouping: Grouping = field(default_factory=Grouping)
    contact: Contact = field(default_factory=Contact)
    gravity: Gravity = field(default_factory=Gravity)
    local_fit: LocalFit = field(default_factory=LocalFit)
    structure: Structure = field(default_factory=Structure)
    watershed: Watershed = field(default_factory=Watershed)
    merging: Merging = field(default_factory=Merging)
    refinement: Refinement = field(default_factory=Refinement)
    color_cuts: ColorCuts = field(default_factory=ColorCuts)
    flat: Flat = field(default_factory=Flat)
    border: Border = field(default_factory=Border)
    contraction: Contraction = field(default_factory=Contraction)
    seams: Seams = field(default_factory=Seams)
    fragments: Fragments = field(default_factory=Fragments)
    height: Height = field(default_factory=Height)
    vessels: Vessels = field(default_factory=Vessels)
    necks: Necks = field(default_factory=Necks)
    occlusion: Occlusion = field(default_factory=Occlusion)
    objectness: Objectness = field(default_factory=Objectness)

    def set(self, name: str, value: Any) -> None:
        """Sets the parameter `group.name`. Its range is checked when the parameters are used."""
        group, _, parameter = name.partition(".")
        owner = getattr(self, group, None) if parameter else self
        target = parameter or group
        if owner is None or target not in getattr(owner, "__slots__", ()) or (not parameter and name != "method"):
            raise ParameterError(f"there is no parameter {name!r}: write group.name, as objectness.threshold")
        setattr(owner, target, value)

    def to_json(self) -> str:
        """JSON of all parameters, as the native half reads it."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Params:
        """Parameters from JSON; what is not named keeps its default."""
        params = cls()
        for group, values in json.loads(text).items():
            if group == "method":
                params.method = values
            else:
                for name, value in values.items():
                    params.set(f"{group}.{name}", value)
        return params

    def to_toml(self) -> str:
        """TOML of all parameters, as `from_toml` and the command line read it."""
        return _native.params_to_toml(self.to_json())

    @classmethod
    def from_toml(cls, text: str) -> Params:
        """Parameters from TOML text; what is not named keeps its default."""
        return cls.from_json(_native.params_from_toml(text))

    def with_profile(self, profile: str) -> Params:
        """The same parameters with the published noise of a kind of sensor: kinect, stereo, tof or phone."""
        return type(self).from_json(_native.params_with_profile(self.to_json(), profile))
