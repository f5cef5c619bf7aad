// The front end with Node and npm of Debian 12, whatever is installed here: its packages install, it bundles to the same page as
// the build's, a suite of its page's tests passes, and the tools run.
//   node node_18.mjs SOURCE_FOLDER WORK_FOLDER PAGE_OF_THE_BUILD      77: npm cannot fetch that Node
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, readFileSync, rmSync } from 'node:fs';
import { delimiter, join, resolve } from 'node:path';

const kNode = '18.20.4';
const kNpm = '9.2.0';
const [source, work, page_of_build] = process.argv.slice(2).map((path) => resolve(path));
const old = join(work, 'node');
const binary = `node-${process.platform}-${process.arch}`;

/** Runs a program to its end. */
const run = (program, words, options = {}) => spawnSync(program, words, { encoding: 'utf8', ...options });

const fetched = run('npm', [
  ...['install', '--prefix', old, '--no-save', '--no-package-lock', '--ignore-scripts', '--prefer-offline', '--no-audit', '--no-fund'],
  ...['--loglevel=error', `${binary}@${kNode}`, `npm@${kNpm}`],
]);
if (fetched.status !== 0) {
  console.log(`skipped: npm cannot fetch ${binary}@${kNode} and npm@${kNpm}: ${fetched.error?.message ?? fetched.stderr.trim().split('\n')[0]}`);
  process.exit(77);
}

const env = { ...process.env, PATH: `${join(old, 'node_modules', binary, 'bin')}${delimiter}${process.env.PATH}` };
const web = join(work, 'web');
/** Runs a command with that Node first in the path; what it said is shown where it fails. */
function with_old_node(cwd, program, ...words) {
  const { status, stdout, stderr, error } = run(program, words, { cwd, env });
  assert.equal(status, 0, `${[program, ...words].join(' ')}: ${error?.message ?? ''}\n${stdout}${stderr}`);
  return stdout;
}
const npm = (...words) => with_old_node(web, 'node', join(old, 'node_modules/npm/bin/npm-cli.js'), ...words);

assert.equal(with_old_node(work, 'node', '--version').trim(), `v${kNode}`);
rmSync(web, { recursive: true, force: true });
cpSync(join(source, 'web'), web, { recursive: true, filter: (path) => !/[/\\](node_modules|dist)$/.test(path) });
assert.equal(npm('--version').trim(), kNpm);
npm('ci', '--prefer-offline', '--loglevel=error');
npm('run', 'build', '--silent');
assert.ok(readFileSync(join(web, 'dist/report.html')).equals(readFileSync(page_of_build)), `the page differs from ${page_of_build}`);
with_old_node(web, 'node', '--test', 'tests/folding.test.mjs');

with_old_node(source, 'node', '--check', 'tools/docs.mjs');
with_old_node(source, 'node', 'tests/build/include_circles.mjs', '.');
// The documents are those that git lists.
if (existsSync(join(source, '.git'))) with_old_node(source, 'node', 'tools/wrap_markdown.mjs', '--check');
