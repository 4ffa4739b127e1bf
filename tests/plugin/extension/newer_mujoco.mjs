// A newer MuJoCo, as a module of Node, for tests.

import fs from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

/** Exit status of a test that is skipped. */
export const SKIPPED = 77;

/** The module, or null and a word on it: where Node looks by itself, and where npm -g puts it. */
export async function loadMujoco() {
  const global = path.join(path.dirname(process.execPath), '..', 'lib', 'node_modules');
  const others = ['/usr/local/lib/node_modules', '/usr/lib/node_modules'];
  const require = createRequire(import.meta.url);
  try {
    const here = require.resolve.paths('mujoco-js');
    const file = require.resolve('mujoco-js', {paths: [...here, global, ...others]});
    return await (await import(pathToFileURL(file))).default();
  } catch (error) {
    if (error.code !== 'MODULE_NOT_FOUND') throw error;
    console.log('skipped: Node has no module mujoco-js (npm install -g mujoco-js)');
    return null;
  }
}

/** All files below a folder. */
function* filesOf(folder) {
  for (const entry of fs.readdirSync(folder, {withFileTypes: true})) {
    const file = path.join(folder, entry.name);
    if (entry.isDirectory()) {
      yield* filesOf(file);
    } else {
      yield file;
    }
  }
}

/** Copies a folder into MuJoCo's own file system, as its root; returns the plants. */
export function mirror(mujoco, root) {
  const plants = [];
  for (const file of filesOf(root)) {
    const name = '/' + path.relative(root, file);
    mujoco.FS.mkdirTree(path.dirname(name));
    mujoco.FS.writeFile(name, fs.readFileSync(file));
    if (path.basename(name) === 'plant.xml') plants.push(name);
  }
  return plants;
}

/** What positions and velocities are off by, where that is more than `same` of the largest. */
export function offBy(data, wanted, same) {
  for (const kind of ['qpos', 'qvel']) {
    const got = Array.from(data[kind]);
    const largest = Math.max(...wanted[kind].map(Math.abs));
    const error = Math.max(...got.map((x, i) => Math.abs(x - wanted[kind][i])));
    if (!(error <= same * largest)) return `${kind} is off by ${error} of ${largest}`;
  }
  return '';
}
