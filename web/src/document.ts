// The report as veridyn/report/document/json.cpp writes it. A missing number is null, an absent text an empty string.

export type Samples = (number | null)[];

export interface Axis {
  label: string;
  unit: string;
}

export interface Verdict {
  level: 'good' | 'caution' | 'bad';
  word: string;
  headline: string;
  lines: string[];
}

export interface Fact {
  name: string;
  value: string;
}

export interface Paragraph {
  kind: 'paragraph';
  text: string;
  tone: 'plain' | 'note' | 'warning';
}

export interface List {
  kind: 'list';
  items: string[];
  tone: 'plain' | 'note' | 'warning';
}

export interface Facts {
  kind: 'facts';
  facts: Fact[];
}

/** A cell: `t` what is shown, `v` its number where it is one, `s` a status. */
export interface Cell {
  t?: string;
  v?: number | null;
  s?: string;
}

export interface Column {
  name: string;
  unit: string;
  align: 'left' | 'right' | 'center';
  group: string;
}

export interface Table {
  kind: 'table';
  title: string;
  caption: string;
  columns: Column[];
  rows: { status: string; cells: Cell[] }[];
  sortable: boolean;
}

export type Role = 'estimate' | 'measured' | 'reference';

/** `x`, `low`, `high`: the 95 % band, on its own abscissae (an index into the figure's `xs`). */
export interface Band {
  x: number;
  low: Samples;
  high: Samples;
}

export interface Line {
  name: string;
  role: Role;
  style: 'line' | 'markers';
  x: number;
  y: Samples;
  band?: Band;
}

export interface Panel {
  label: string;
  unit: string;
  height: number;
  lines: Line[];
}

export interface Span {
  from: number;
  to: number;
  label: string;
  tone: 'primary' | 'secondary' | 'muted' | 'bad';
}

/** A piece of the abscissa; a figure with windows shows these alone, side by side. */
export interface Window {
  from: number;
  to: number;
}

export interface TimeSeries {
  kind: 'time_series';
  title: string;
  caption: string;
  footnote: string;
  axis: string;
  x: Axis;
  xs: number[][];
  panels: Panel[];
  spans: Span[];
  windows?: Window[];
}

export interface XYSeries {
  name: string;
  role: Role;
  style: 'line' | 'markers' | 'stems';
  width: number;
  opacity: number;
  x: Samples;
  y: Samples;
}

export interface XYPlot {
  kind: 'xy';
  title: string;
  caption: string;
  footnote: string;
  x: Axis;
  y: Axis;
  height: number;
  equal_axes: boolean;
  equal_scale: boolean;
  /** Decades along the abscissa. */
  log_x?: boolean;
  series: XYSeries[];
  /** Shaded between two lines; a missing end: as far as the plot goes. */
  areas?: { name: string; x: Samples; low: Samples; high: Samples }[];
  guides: { direction: 'horizontal' | 'vertical'; value: number; label: string }[];
}

export interface Estimate {
  method: number;
  value: number | null;
  low: number | null;
  high: number | null;
  status: string;
}

export interface IntervalPlot {
  kind: 'intervals';
  title: string;
  caption: string;
  methods: string[];
  reference: string;
  shared_scale: boolean;
  rows: { name: string; unit: string; reference: number | null; estimates: Estimate[] }[];
}

export interface Matrix {
  kind: 'matrix';
  title: string;
  caption: string;
  rows: string[];
  columns: string[];
  values: Samples[];
  low: number;
  high: number;
  decimals: number;
}

export type SceneTone = 'ground' | 'body' | 'link' | 'person' | 'outline';

/** Points: forward, left, up [m], and whether they move with the body. */
export interface SceneShape {
  kind: 'line' | 'face' | 'ball' | 'actuator' | 'label';
  tone: SceneTone;
  points: [number, number, number, 0 | 1][];
  size: number;
  text: string;
}

export interface SceneJoint {
  name: string;
  unit: string;
  turns: boolean;
  direction: [number, number, number];
  scale: number;
}

/** A drawing in space that moves; `values` by joint and sample. */
export interface Scene {
  kind: 'scene';
  title: string;
  caption: string;
  axis: string;
  x: Axis;
  samples: number[];
  shapes: SceneShape[];
  joints: SceneJoint[];
  motions: { name: string; values: Samples[] }[];
  choice: string;
  height: number;
}

export type Block = Paragraph | List | Facts | Table | TimeSeries | XYPlot | IntervalPlot | Matrix | Scene;

export interface Section {
  title: string;
  id: string;
  folded: boolean;
  /** Said beside the title; empty: how many tables and figures. */
  inside: string;
  blocks: Block[];
}

export interface Document {
  format: 'veridyn-report';
  version: number;
  generator: string;
  title: string;
  subtitle: string;
  verdict: Verdict;
  /** On the first screen, below the verdict. */
  lead: Block[];
  facts: Fact[];
  sections: Section[];
}
