// Draws the pictures of examples/README.md from what the numbered examples computed:
//   node tools/example_pictures.mjs FOLDER OUT       FOLDER holds NN_name.csv, OUT becomes NN_name.svg
// Fails where a table or a column is missing, and where an example has no picture here or is not in examples/README.md. The
// camera's is left out, with a note, where there is no table of it (a build without OpenCV). `make pictures` runs all of it.
import { existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { plot } from './svg_plot.mjs';

const longest = 500; // points of a line

// A table: column(name) in the order of its rows, from `from` to `to` of its first column, thinned to `longest` rows.
function readTable(file) {
  const rows = readFileSync(file, 'utf8').split('\n').filter((row) => row && !row.startsWith('#')).map((row) => row.split(','));
  const head = rows.shift();
  const at = (name) => {
    const k = head.indexOf(name);
    if (k < 0) throw new Error(`${file} has no column '${name}'; it has ${head.join(', ')}`);
    return k;
  };
  return {
    labels: () => rows.map((row) => row[at('label')]),
    all: (name) => rows.map((row) => Number(row[at(name)])),
    columns(from = -Infinity, to = Infinity) {
      const within = rows.filter((row) => Number(row[0]) >= from && Number(row[0]) <= to);
      const thinned = within.filter((_, k) => k % Math.ceil(within.length / longest) === 0);
      return (name) => thinned.map((row) => Number(row[at(name)]));
    },
  };
}

// Estimates over their true values. Faint: not distinguishable from zero.
function overTruth(table) {
  const [value, low, high, truth] = ['value', 'low', 'high', 'true'].map((name) => table.all(name));
  return table.labels().map((label, k) => {
    const ends = [low[k] / truth[k], high[k] / truth[k]].sort((a, b) => a - b);
    return { label, value: value[k] / truth[k], low: ends[0], high: ends[1], faint: low[k] * high[k] <= 0 };
  }).filter((row) => Number.isFinite(row.value));
}
const byParameter = (rows) => rows.map((row) => row.label.split(' by ')[0]).filter((name, k, all) => all.indexOf(name) === k)
  .flatMap((name) => rows.filter((row) => row.label.startsWith(`${name} by `)));

const time = 'time [s]';
const pictures = {
  '01_read_a_log'(table) {
    const c = table.columns(), x = c('time[s]');
    return [
      { kind: 'lines', yLabel: 'gyro_y [rad/s]', height: 120, series: [{ x, y: c('gyro_y[rad/s]') }] },
      { kind: 'lines', yLabel: 'elevator [rad]', height: 120, xLabel: time, series: [{ x, y: c('elevator[rad]') }] },
    ];
  },
  '02_regression': (table) => [
    { kind: 'intervals', truth: 1, xLabel: 'estimate over true value, with 95 % interval', rows: byParameter(overTruth(table)) },
  ],
  '03_filter_and_differentiate'(table) {
    const c = table.columns(10, 13), x = c('time[s]');
    return [{
      kind: 'lines', height: 230, yLabel: 'angular acceleration [rad/s²]', xLabel: time, series: [
        { x, y: c('central_difference[rad/s^2]'), name: 'central difference', colour: '#b9bec6' },
        { x, y: c('filter[rad/s^2]'), name: 'filter' },
        { x, y: c('truth[rad/s^2]'), name: 'truth', style: 'truth' },
      ],
    }];
  },
  '04_reconstruct'(table) {
    const c = table.columns(20, 32), x = c('time[s]');
    return [{
      kind: 'lines', height: 230, yLabel: 'angle of attack [deg]', xLabel: time, series: [
        { x, y: c('low[deg]'), high: c('high[deg]'), style: 'band', name: '95 % band', colour: '#1f5fbf' },
        { x, y: c('alpha[deg]'), name: 'estimate' },
        { x, y: c('truth[deg]'), name: 'truth', style: 'truth' },
      ],
    }];
  },
  '05_identify': (table) => [{
    kind: 'intervals', truth: 1, range: [-0.5, 2.5], rows: overTruth(table),
    xLabel: 'estimate over true value, with 95 % interval; grey: not distinguishable from zero',
  }],
  '06_move_an_arm'(table) {
    const c = table.columns(), x = c('time[s]');
    return [
      { kind: 'lines', yLabel: 'elbow [deg]', height: 130, series: [{ x, y: c('elbow[deg]') }] },
      {
        kind: 'lines', yLabel: 'tendon force [N]', height: 130, xLabel: time, series: [
          { x, y: c('brachialis[N]'), name: 'brachialis, at 10 % of its activation' },
          { x, y: c('triceps[N]'), name: 'triceps, long head, at 2 %' },
        ],
      },
    ];
  },
  '07_scale_a_car'(table) {
    const values = table.all('mismatch[%]');
    const rows = table.labels().map((label, k) => ({ label, value: values[k], note: Math.abs(values[k]) > 0.05 ? `${values[k].toFixed(1)} %`.replace('-', '\u2212') : '' }));
    return [{ kind: 'bars', rows, xLabel: 'dimensionless groups of the model that was built, against those of the car [%]' }];
  },
  '08_identify_a_car': (table) => [
    { kind: 'intervals', truth: 1, xLabel: 'estimate over true value, with 95 % interval', rows: byParameter(overTruth(table)) },
  ],
  '09_cue_a_drive'(table) {
    const c = table.columns(), x = c('time[s]');
    return [
      {
        kind: 'lines', yLabel: 'lateral force felt [m/s²]', height: 190, series: [
          { x, y: c('car[m/s^2]'), name: 'in the car', style: 'truth' },
          { x, y: c('three_axis[m/s^2]'), name: 'platform, three_axis' },
          { x, y: c('optimal[m/s^2]'), name: 'platform, optimal' },
        ],
      },
      { kind: 'lines', yLabel: 'roll [deg]', height: 110, xLabel: time, series: [{ x, y: c('roll[deg]'), name: 'of the platform, optimal', colour: '#c2570c' }] },
    ];
  },
  '10_track_a_car'(table) {
    const c = table.columns(5), x = c('time[s]');
    return [{
      kind: 'lines', height: 230, yLabel: 'cornering stiffness, front [kN/rad]', xLabel: time, series: [
        { x, y: c('low[kN/rad]'), high: c('high[kN/rad]'), style: 'band', name: '95 % band', colour: '#1f5fbf' },
        { x, y: c('C_f[kN/rad]'), name: 'estimate, on line' },
        { x, y: c('truth[kN/rad]'), name: 'truth', style: 'truth' },
      ],
    }];
  },
  '11_follow_a_car_live'(table) {
    const c = table.columns(), x = c('time[s]');
    return [
      { kind: 'lines', yLabel: 'lateral [m/s²]', height: 110, series: [{ x, y: c('force[m/s^2]'), name: 'force on the driver, by telemetry; none from 35 s to 40 s' }] },
      {
        kind: 'lines', yLabel: 'roll [deg]', height: 130, series: [
          { x, y: c('ordered[deg]'), name: 'ordered' },
          { x, y: c('reached[deg]'), name: 'reached by the platform', style: 'truth' },
        ],
      },
      { kind: 'lines', yLabel: 'share [%]', height: 80, xLabel: time, series: [{ x, y: c('share[%]'), name: 'of the motion that the platform is given', colour: '#3f7d3a' }] },
    ];
  },
  '12_see_a_car'(table) {
    const c = table.columns();
    return [
      {
        kind: 'lines', equal: true, yLabel: 'y [m]', xLabel: 'x [m], on the track', series: [
          { x: c('true_x[m]'), y: c('true_y[m]'), name: 'truth', style: 'truth' },
          { x: c('x[m]'), y: c('y[m]'), name: 'by the camera, a dot a picture', style: 'dots' },
        ],
      },
      {
        kind: 'lines', height: 110, yLabel: 'error in x [mm]', xLabel: time, series: [
          { x: c('time[s]'), y: c('low[mm]'), high: c('high[mm]'), style: 'band', name: '95 % band; the car is hidden from 3.0 s to 3.3 s', colour: '#1f5fbf' },
          { x: c('time[s]'), y: c('error[mm]'), name: 'error' },
        ],
      },
    ];
  },
};

const [folder, out] = process.argv.slice(2);
if (!folder || !out) {
  console.error('usage: node tools/example_pictures.mjs FOLDER OUT');
  process.exit(2);
}
const home = join(dirname(fileURLToPath(import.meta.url)), '../examples');
const page = readFileSync(join(home, 'README.md'), 'utf8');
const examples = readdirSync(home).filter((file) => /^\d\d_.*\.cpp$/.test(file)).map((file) => file.replace('.cpp', ''));
mkdirSync(out, { recursive: true });
for (const name of examples) {
  for (const named of [`(${name}.cpp)`, `/${name}.svg)`]) {
    if (!page.includes(named)) throw new Error(`examples/README.md does not show ${name}: no ${named}`);
  }
  const table = join(folder, `${name}.csv`);
  if (name === '12_see_a_car' && !existsSync(table)) {
    console.log(`${name}: left out, the library has no camera module`);
    continue;
  }
  if (!pictures[name]) throw new Error(`examples/${name}.cpp has no picture in tools/example_pictures.mjs`);
  writeFileSync(join(out, `${name}.svg`), plot(pictures[name](readTable(table))));
}
