// Bundles the front end into one page, dist/report.html: a report is mailed and opened years later without a network.
//   node build.mjs
import { build } from 'esbuild';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';

const { outputFiles } = await build({
  entryPoints: ['src/main.ts'],
  outdir: 'dist',
  write: false,
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  charset: 'utf8',
  logLevel: 'warning',
});

/** The bundle of this kind, 'js' or 'css'; there is one of each. */
function bundle(kind) {
  const names = outputFiles.map((file) => file.path);
  const of_kind = outputFiles.filter((file) => file.path.endsWith(`.${kind}`));
  if (outputFiles.length !== 2 || of_kind.length !== 1) throw new Error(`one script and one style sheet are expected, not ${names.join(', ')}`);
  return of_kind[0].text.trim();
}

let page = readFileSync('report.html', 'utf8');
/** Puts a text in the place of a marker; as a function, since a bundle may contain "$&". */
function put(marker, text) {
  if (page.split(marker).length !== 2) throw new Error(`${marker} must stand in report.html exactly once`);
  page = page.replace(marker, () => text);
}
put('@@VERIDYN_STYLE@@', bundle('css'));
// In a script element these two would end it or begin a comment.
put('@@VERIDYN_SCRIPT@@', bundle('js').replace(/<\/script/gi, '<\\/script').replace(/<!--/g, '<\\!--'));
for (const marker of ['@@VERIDYN_TITLE@@', '@@VERIDYN_STATIC@@', '@@VERIDYN_DOCUMENT@@']) {
  if (page.split(marker).length !== 2) throw new Error(`${marker} must stand in the page exactly once`);
}
mkdirSync('dist', { recursive: true });
writeFileSync('dist/report.html', page);
