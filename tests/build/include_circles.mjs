// Fails where files or folders of the library, the reproductions and the program include each other in a circle, a folder taken
// with all below it too; where a file includes one of the folder above its own; or where a module includes one that is not to
// its left in the line of layers of docs/architecture.md ("core < numerics < ... < (aircraft, vehicle, muscle) < ...").
//   node include_circles.mjs SOURCE_FOLDER
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

const root = process.argv[2];
/// The sources of a folder, deep.
function sources(folder) {
  return readdirSync(join(root, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = `${folder}/${entry.name}`;
    if (entry.isDirectory()) return sources(path);
    return /\.[ch]pp$/.test(entry.name) ? [path] : [];
  });
}
const files = ['veridyn', 'bench/reproduction', 'apps'].flatMap(sources);

/// The edges of a graph as a map from each node to those that it includes, itself left out.
function graph(edges) {
  const to = new Map();
  for (const [from, included] of edges) {
    if (!to.has(from)) to.set(from, new Set());
    if (from !== included) to.get(from).add(included);
  }
  return to;
}

/// One circle of a graph as the nodes on it, the first one again at the end; null: there is none.
function circle(to) {
  const done = new Set();
  const path = [];
  function visit(node) {
    const begin = path.indexOf(node);
    if (begin >= 0) return [...path.slice(begin), node];
    if (done.has(node)) return null;
    path.push(node);
    for (const next of to.get(node) ?? []) {
      const found = visit(next);
      if (found) return found;
    }
    path.pop();
    done.add(node);
    return null;
  }
  for (const node of to.keys()) {
    const found = visit(node);
    if (found) return found;
  }
  return null;
}

/// The folders that a file lies in, from its own up.
function parents(file) {
  const folders = [];
  for (let folder = dirname(file); folder !== '.'; folder = dirname(folder)) folders.push(folder);
  return folders;
}
const isFile = (path) => /\.[ch]pp$/.test(path);

/// The layer of each module, from the lowest.
function layers() {
  const text = readFileSync(join(root, 'docs/architecture.md'), 'utf8');
  const line = text.match(/^ {4}(core < .+)$/m);
  if (!line) throw new Error('docs/architecture.md: no line of layers, "core < numerics < ..."');
  const of = new Map();
  line[1].split('<').forEach((modules, layer) => {
    for (const name of modules.match(/[a-z]+/g)) of.set(name, layer);
  });
  return of;
}

const edges = files.flatMap((file) =>
  [...readFileSync(join(root, file), 'utf8').matchAll(/^\s*#\s*include "((?:veridyn|bench|apps)\/[^"]+)"/gm)].map(([, included]) => [file, included]),
);
// bench/reproduction counts as the module `reproduction`, the face veridyn/io.hpp as part of `io`.
const moduleOf = (file) => (file.startsWith('apps/') ? 'apps' : file.split('/')[1].replace('.hpp', ''));
const faults = [];
for (const [what, named] of [['files', (file) => file], ['folders', dirname]]) {
  const found = circle(graph(edges.map(([from, to]) => [named(from), named(to)])));
  if (found) faults.push(`${what} include each other: ${found.join(' -> ')}`);
}
/// The entry of `folder` that a file lies in or is: a/b/c.hpp and a/b/d/e.hpp are a/b/d and a/b/c.hpp of a/b; null: elsewhere.
function entryOf(folder, file) {
  if (!file.startsWith(`${folder}/`)) return null;
  const name = file.slice(folder.length + 1).split('/')[0];
  return `${folder}/${name}`;
}
for (const folder of new Set(files.flatMap((file) => parents(file)))) {
  const inside = edges.map(([from, to]) => [entryOf(folder, from), entryOf(folder, to)]);
  const found = circle(graph(inside.filter(([from, to]) => from !== null && to !== null && !isFile(from) && !isFile(to))));
  if (found) faults.push(`folders with all below them include each other: ${found.join(' -> ')}`);
}
// What lies directly in a folder puts together what its sub-folders do.
for (const [from, to] of edges) {
  const above = dirname(to);
  if (above !== dirname(from) && parents(from).includes(above)) faults.push(`${from} includes ${to}, of a folder above`);
}
const layer = layers();
for (const [from, to] of edges) {
  const [above, below] = [moduleOf(from), moduleOf(to)];
  if (!layer.has(above) || !layer.has(below)) faults.push(`docs/architecture.md: no layer for ${layer.has(above) ? below : above}`);
  else if (above !== below && !(layer.get(below) < layer.get(above))) faults.push(`${from} includes ${to}, which is not of a layer below`);
}
for (const fault of new Set(faults)) console.error(fault);
process.exit(faults.length > 0 ? 1 : 0);
