import type { Scene, SceneJoint, SceneShape, SceneTone } from '../document';

export type Place = [number, number, number];

/** From where a scene is seen: the direction of the eye about the vertical, from forward to the left, and above [rad]. */
export interface View {
  azimuth: number;
  elevation: number;
}

/** From behind, on the right. */
export const kFirstView: View = { azimuth: (222 * Math.PI) / 180, elevation: (20 * Math.PI) / 180 };

const kLowest = (2 * Math.PI) / 180;
const kHighest = (88 * Math.PI) / 180;
/** Distance of the eye over the radius of the scene: some perspective, no distortion. */
const kEyeDistance = 5;

/** Share of the picture that the scene takes; the rest is for what a turn adds, and for perspective. */
const kFilled = 0.95;

export function turned(view: View, azimuth: number, elevation: number): View {
  return { azimuth: view.azimuth + azimuth, elevation: Math.min(kHighest, Math.max(kLowest, view.elevation + elevation)) };
}

function cross(a: Place, b: Place): Place {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function dot(a: Place, b: Place): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** A place turned about a direction (Rodrigues). */
function turn(place: Place, about: Place, angle: number): Place {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const across = cross(about, place);
  const along = dot(about, place) * (1 - c);
  return [0, 1, 2].map((k) => (place[k] as number) * c + (across[k] as number) * s + (about[k] as number) * along) as Place;
}

/** Where a place of the body is: the last joint carries it, the first stands on the ground. */
export function carried(place: Place, joints: SceneJoint[], values: number[]): Place {
  let at = place;
  for (let k = joints.length - 1; k >= 0; --k) {
    const { direction, turns, scale } = joints[k] as SceneJoint;
    const by = (values[k] ?? 0) * scale;
    at = turns ? turn(at, direction, by) : [at[0] + by * direction[0], at[1] + by * direction[1], at[2] + by * direction[2]];
  }
  return at;
}

/** The middle and the radius of a ball that holds the scene in all its shifts. */
export function bounds(scene: Scene): { middle: Place; radius: number } {
  const low: Place = [Infinity, Infinity, Infinity];
  const high: Place = [-Infinity, -Infinity, -Infinity];
  for (const shape of scene.shapes) {
    for (const point of shape.points) {
      for (const k of [0, 1, 2] as const) {
        low[k] = Math.min(low[k], point[k]);
        high[k] = Math.max(high[k], point[k]);
      }
    }
  }
  if (!(low[0] <= high[0])) return { middle: [0, 0, 0], radius: 1 };
  const middle = [0, 1, 2].map((k) => 0.5 * ((low[k] as number) + (high[k] as number))) as Place;
  let travel = 0;
  scene.joints.forEach((joint, k) => {
    if (joint.turns) return;
    let most = 0;
    for (const motion of scene.motions) for (const value of motion.values[k] ?? []) most = Math.max(most, Math.abs((value ?? 0) * joint.scale));
    travel += most * most;
  });
  let radius = 0;
  for (const { kind, points, size } of scene.shapes) {
    const around = kind === 'ball' ? size : 0;
    for (const [x, y, z, moves] of points) radius = Math.max(radius, Math.hypot(x - middle[0], y - middle[1], z - middle[2]) + around + (moves ? Math.sqrt(travel) : 0));
  }
  return { middle, radius: Math.max(radius, 1e-3) };
}

/** Something to be drawn, farthest first. */
export interface Stroke {
  kind: 'line' | 'face' | 'ball' | 'label';
  tone: SceneTone;
  points: [number, number][];
  /** Width of a line, radius of a ball [px]. */
  size: number;
  text: string;
}

/** The scene as it looks from `view`, in a picture of `width` and `height`. */
export function seen(scene: Scene, values: number[], view: View, extent: { middle: Place; radius: number }, width: number, height: number): Stroke[] {
  const { middle, radius } = extent;
  const eye: Place = [Math.cos(view.elevation) * Math.cos(view.azimuth), Math.cos(view.elevation) * Math.sin(view.azimuth), Math.sin(view.elevation)];
  const right: Place = [-Math.sin(view.azimuth), Math.cos(view.azimuth), 0];
  const up = cross(eye, right);
  const scale = (kFilled * Math.min(width, height)) / (2 * radius);
  const project = (place: Place): { at: [number, number]; near: number; scale: number } => {
    const from: Place = [place[0] - middle[0], place[1] - middle[1], place[2] - middle[2]];
    const near = dot(eye, from);
    const s = (scale * kEyeDistance * radius) / (kEyeDistance * radius - near);
    return { at: [0.5 * width + s * dot(right, from), 0.5 * height - s * dot(up, from)], near, scale: s };
  };
  const strokes: (Stroke & { near: number })[] = [];
  const add = (kind: Stroke['kind'], shape: SceneShape, places: Place[], size: number) => {
    const projected = places.map(project);
    const near = projected.reduce((sum, each) => sum + each.near, 0) / Math.max(1, projected.length);
    // The ground never hides what stands on it.
    const behind = shape.tone === 'ground' ? 10 * radius : 0;
    strokes.push({ kind, tone: shape.tone, points: projected.map((each) => each.at), size: kind === 'ball' ? size * (projected[0]?.scale ?? 1) : size, text: shape.text, near: near - behind });
  };
  for (const shape of scene.shapes) {
    const places = shape.points.map(([x, y, z, moves]) => (moves ? carried([x, y, z], scene.joints, values) : ([x, y, z] as Place)));
    if (shape.kind !== 'actuator') {
      add(shape.kind, shape, places, shape.size);
      continue;
    }
    const [foot, head] = places as [Place, Place];
    const length = Math.hypot(head[0] - foot[0], head[1] - foot[1], head[2] - foot[2]);
    const share = length > 0 ? Math.min(1, shape.size / length) : 0;
    const end = [0, 1, 2].map((k) => (foot[k] as number) + share * ((head[k] as number) - (foot[k] as number))) as Place;
    add('line', shape, [end, head], 3);
    add('line', shape, [foot, end], 8);
  }
  return strokes.sort((a, b) => a.near - b.near);
}
