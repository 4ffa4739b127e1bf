// Every extended plant of the tests loads in a newer MuJoCo, as it is, and moves there as in
// the one that mjdiag builds on. MuJoCo comes as a module of Node, `npm install -g mujoco-js`;
// without it the test is skipped.
//
// node newer_mujoco_test.mjs EXTENDED_PLANTS PLUGIN_TEST: the program that writes plants
// with every effect (extended_plants.cc), and the tests that extend other people's MJCF.

import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

import {SKIPPED, loadMujoco, mirror, offBy} from './newer_mujoco.mjs';

const STEPS = 100;
// Of positions and velocities, relative to the largest: rounding, and friction constraints that
// either version solves to its own tolerance.
const SAME = 1e-8;

/** Steps a plant by those commands, or without any; returns what is wrong, or nothing. */
function faultOf(mujoco, name, stock) {
  const model = mujoco.MjModel.loadFromXML(name);
  const data = new mujoco.MjData(model);
  try {
    const steps = stock ? stock.commands.length : STEPS;
    for (let step = 0; step < steps; ++step) {
      if (stock) data.ctrl.set(stock.commands[step]);
      mujoco.mj_step(model, data);
    }
    // What diverges MuJoCo begins anew.
    const time = steps * model.opt.timestep;
    if (Math.abs(data.time - time) > 1e-9 * time) return 'diverges';
    return stock ? offBy(data, stock, SAME) : '';
  } finally {
    data.delete();
    model.delete();
  }
}

function writePlants(folder, extendedPlants, pluginTest) {
  execFileSync(extendedPlants, [path.join(folder, 'every_effect')], {stdio: 'inherit'});
  // Each effect by itself is among those already.
  const tests = '--gtest_filter=ExtendedMjcf.*:ExtendedPlant.*-*EveryEffectByItself';
  execFileSync(pluginTest, [tests], {
    stdio: ['ignore', 'ignore', 'inherit'],
    env: {...process.env, MJDIAG_KEPT_FOLDERS: folder},
  });
}

async function main(extendedPlants, pluginTest) {
  const mujoco = await loadMujoco();
  if (!mujoco) return SKIPPED;
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'mjdiag-plants-'));
  let failures = 0;
  let compared = 0;
  try {
    writePlants(folder, extendedPlants, pluginTest);
    const plants = mirror(mujoco, folder);
    for (const plant of plants) {
      const file = path.join(folder, path.dirname(plant), 'stock.json');
      const stock = fs.existsSync(file) ? JSON.parse(fs.readFileSync(file)) : null;
      compared += stock ? 1 : 0;
      let fault = '';
      try {
        fault = faultOf(mujoco, plant, stock);
      } catch (error) {
        fault = `${error.message ?? error}`;
      }
      if (!fault) continue;
      ++failures;
      console.log(`${plant}: ${fault}`);
    }
    console.log(`MuJoCo ${mujoco.mj_versionString()}: ${plants.length} plants, of which ` +
                `${compared} compared; ${failures} failed`);
    if (compared < 100 || plants.length <= compared) ++failures;  // not even looked at
  } finally {
    fs.rmSync(folder, {recursive: true});
  }
  return failures ? 1 : 0;
}

process.exitCode = await main(...process.argv.slice(2));
