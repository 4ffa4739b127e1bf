// In a newer MuJoCo effects.py moves extended plants as mjdiag does. MuJoCo's Python package is
// not everywhere, so MuJoCo runs in Node, and asks a Python beside it in every step
// (newer_effects.py). Skipped without the module mujoco-js.
//
// node newer_effects_test.mjs PYTHON EXTENDED_PLANTS

import {execFileSync, spawn} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import readline from 'node:readline';
import {fileURLToPath} from 'node:url';

import {SKIPPED, loadMujoco, mirror, offBy} from './newer_mujoco.mjs';

// Relative to the largest: rounding, and friction that either version solves to its own
// tolerance.
const SAME = 1e-8;
// force_coupling asks whether a motor has no arm on the joint. One that is nothing at rest is
// 1e-17 in another version, which counts for a step.
const ASKS_FOR_ARMS = /ab383_(\d+_force_coupling|all)\//;
const NEARLY_SAME = 1e-5;

const OF_MODEL = `names name_jntadr name_actuatoradr name_sensoradr name_numericadr numeric_adr
  numeric_size numeric_data jnt_type jnt_dofadr jnt_qposadr jnt_stiffness dof_jntid dof_damping
  dof_frictionloss dof_solref dof_solimp dof_invweight0 qpos0 qpos_spring actuator_gear
  actuator_trntype actuator_trnid actuator_dyntype actuator_gaintype actuator_biastype
  actuator_gainprm actuator_biasprm actuator_ctrllimited actuator_ctrlrange
  actuator_forcelimited actuator_forcerange actuator_length0 sensor_adr sensor_dim`;
const OF_DATA = `qpos qvel ctrl actuator_length actuator_velocity actuator_moment moment_rownnz
  moment_rowadr moment_colind qfrc_passive qfrc_bias efc_type efc_id efc_frictionloss iefc_type
  iefc_id iefc_frictionloss`;

function listsOf(of, names) {
  const pairs = names.split(/\s+/).map((name) => [name, Array.from(of[name])]);
  return Object.fromEntries(pairs);
}

/** A Python that answers a line with a line. */
class Effects {
  constructor(python) {
    const script = fileURLToPath(new URL('newer_effects.py', import.meta.url));
    this.process = spawn(python, ['-B', script], {stdio: ['pipe', 'pipe', 'inherit']});
    this.lines = readline.createInterface({input: this.process.stdout})[Symbol.asyncIterator]();
  }
  async ask(message) {
    this.process.stdin.write(JSON.stringify(message) + '\n');
    const {value, done} = await this.lines.next();
    if (done) throw new Error('effects.py has failed');
    return JSON.parse(value);
  }
  end() {
    this.process.stdin.end();
  }
}

/** Moves a plant with its effects; returns what is wrong, or nothing. */
async function faultOf(mujoco, plant, folder, wanted, effects) {
  const model = mujoco.MjModel.loadFromXML(plant);
  const fields = listsOf(model, OF_MODEL);
  const {timestep, integrator} = model.opt;
  Object.assign(fields, {nu: model.nu, nv: model.nv, timestep, integrator});
  const changed = await effects.ask({folder, model: fields});
  for (const [name, values] of Object.entries(changed)) model[name].set(values);
  const data = new mujoco.MjData(model);
  try {
    for (const command of wanted.commands) {
      data.ctrl.set(command);
      mujoco.mj_step1(model, data);
      const {time, nisland} = data;
      const given = await effects.ask({time, nisland, ...listsOf(data, OF_DATA)});
      for (const [name, values] of Object.entries(given)) data[name].set(values);
      mujoco.mj_step2(model, data);
    }
    return offBy(data, wanted, ASKS_FOR_ARMS.test(plant) ? NEARLY_SAME : SAME);
  } finally {
    data.delete();
    model.delete();
  }
}

async function main(python, extendedPlants) {
  const mujoco = await loadMujoco();
  if (!mujoco) return SKIPPED;
  const root = fs.mkdtempSync(path.join(os.tmpdir(), 'mjdiag-effects-'));
  const effects = new Effects(python);
  let failures = 0;
  let moved = 0;
  try {
    execFileSync(extendedPlants, [root], {stdio: 'inherit'});
    for (const plant of mirror(mujoco, root)) {
      const folder = path.join(root, path.dirname(plant));
      const wanted = JSON.parse(fs.readFileSync(path.join(folder, 'moved.json')));
      if (!wanted || !fs.existsSync(path.join(folder, 'effects.py'))) continue;
      ++moved;
      const fault = await faultOf(mujoco, plant, folder, wanted, effects);
      if (!fault) continue;
      ++failures;
      console.log(`${plant}: ${fault}`);
    }
    console.log(`MuJoCo ${mujoco.mj_versionString()}: ${moved} plants moved, ` +
                `${failures} otherwise`);
    if (moved < 100) ++failures;  // not even tried
  } finally {
    effects.end();
    fs.rmSync(root, {recursive: true});
  }
  return failures ? 1 : 0;
}

process.exitCode = await main(...process.argv.slice(2));
