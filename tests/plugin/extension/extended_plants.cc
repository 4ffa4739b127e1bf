// extended_plants FOLDER: writes an extended plant of every machine of mjcf/ with every effect
// by itself, and with all of them, each into a folder of its own. Beside it, in steps.json,
// what that effect does along a motion (active_effect.h), and how the plant is moved by its
// motors, in stock.json by MuJoCo alone and in moved.json with the effect: what programs that
// are no mjdiag have to make of plant.xml and effects.py.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/text_file.h"
#include "support/changes.h"
#include "support/every_effect.h"

namespace mjdiag::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kSteps = 60;
constexpr int kStockSteps = 100;

/// A machine, what to put into it, and how far and fast it is moved.
struct Subject {
  std::string machine;
  std::vector<std::string> effects;
  double stroke;  // [m, rad]
  double speed;   // [m/s, rad/s]
  double command;
};

std::vector<Subject> Subjects() {
  const std::vector<std::string> coil = WithDrawn(
      {}, {.stroke = 2e-3, .speed = 0.1, .force = 10.0, .mass = 0.2, .duration = 1.0},
      {"stage", "stage", "coil", "encoder", ""});
  const std::vector<std::string> servo = WithDrawn(
      {"flexible_mode@shaft:mass=1e-3,frequency=31.3,damping_ratio=0.07"},
      {.stroke = 2.0, .speed = 5.0, .force = 2.0, .mass = 0.01, .duration = 1.0},
      {"shaft", "", "motor", "encoder", "shaft"});
  const std::vector<std::string> panda = WithDrawn(
      {"flexible_mode@joint4:mass=0.03,frequency=11.3,damping_ratio=0.07",
       "force_curve@joint4:variable=0,of=1,factor=1,still=0.3,low=-1,width=2,shape=0,"
       "knots=5,force_1=1.1,force_2=-0.7,force_3=0.3,force_4=2.1,force_5=0.9",
       "force_curve@joint2:variable=3,of=0,low=0,width=0.013,shape=1,knots=4,"
       "force_1=1.1,force_2=-0.7,force_3=0.3,force_4=2.1",
       "force_curve@joint2:variable=1,of=1,factor=2,still=0.4,low=-1,width=2.3,shape=2,"
       "knots=9,force_1=1.1,force_2=-0.7,force_3=0.3,force_4=2.1,force_5=0.9,"
       "force_6=-1.1,force_7=0.2,force_8=0.6,force_9=7",
       "force_curve@joint6:variable=2,of=3,low=-7,width=20,shape=0,knots=4,"
       "force_1=1.1,force_2=-0.7,force_3=0.3,force_4=2.1",
       "bouc_wen@joint5:stiffness=13,loss=0.7,hardening=2.1,exponent=1.7"},
      {.stroke = 1.0, .speed = 2.0, .force = 20.0, .mass = 0.3, .duration = 1.0},
      {"joint4", "", "motor4", "encoder4", "joint2"});
  return {{"ab383", EveryEffectOfAb383(), 2e-3, 0.3, 300.0},
          {"emps", EveryEffectOfEmps(), 0.2, 0.2, 3.0},
          // One motor has no other to be coupled to.
          {"voice_coil", Without(coil, "force_coupling"), 2e-3, 0.1, 1.0},
          {"servo", Without(servo, "force_coupling"), 2.0, 5.0, 12.0},
          {"panda", panda, 1.0, 2.0, 20.0}};
}

Json List(const mjtNum* values, int count) {
  return std::vector<mjtNum>(values, values + count);
}
template <class Integer>
Json Integers(const Integer* values, int count) {
  return std::vector<int>(values, values + count);
}

/// What `prepare` changes.
Json Changing(const mjModel& m) {
  return {{"qpos0", List(m.qpos0, m.nq)},
          {"qpos_spring", List(m.qpos_spring, m.nq)},
          {"dof_frictionloss", List(m.dof_frictionloss, m.nv)},
          {"dof_solref", List(m.dof_solref, m.nv * mjNREF)},
          {"dof_solimp", List(m.dof_solimp, m.nv * mjNIMP)}};
}

Json ModelJson(const mjModel& m) {
  Json json = Changing(m);
  json.update({{"nu", m.nu},
               {"nv", m.nv},
               {"timestep", m.opt.timestep},
               {"integrator", m.opt.integrator},
               {"names", Integers(m.names, m.nnames)},
               {"name_jntadr", Integers(m.name_jntadr, m.njnt)},
               {"name_actuatoradr", Integers(m.name_actuatoradr, m.nu)},
               {"name_sensoradr", Integers(m.name_sensoradr, m.nsensor)},
               {"name_numericadr", Integers(m.name_numericadr, m.nnumeric)},
               {"numeric_adr", Integers(m.numeric_adr, m.nnumeric)},
               {"numeric_size", Integers(m.numeric_size, m.nnumeric)},
               {"numeric_data", List(m.numeric_data, m.nnumericdata)},
               {"jnt_type", Integers(m.jnt_type, m.njnt)},
               {"jnt_dofadr", Integers(m.jnt_dofadr, m.njnt)},
               {"jnt_qposadr", Integers(m.jnt_qposadr, m.njnt)},
               {"jnt_stiffness", List(m.jnt_stiffness, m.njnt)},
               {"dof_jntid", Integers(m.dof_jntid, m.nv)},
               {"dof_damping", List(m.dof_damping, m.nv)},
               {"dof_invweight0", List(m.dof_invweight0, m.nv)},
               {"actuator_gear", List(m.actuator_gear, m.nu * 6)},
               {"actuator_trntype", Integers(m.actuator_trntype, m.nu)},
               {"actuator_trnid", Integers(m.actuator_trnid, m.nu * 2)},
               {"actuator_dyntype", Integers(m.actuator_dyntype, m.nu)},
               {"actuator_gaintype", Integers(m.actuator_gaintype, m.nu)},
               {"actuator_biastype", Integers(m.actuator_biastype, m.nu)},
               {"actuator_gainprm", List(m.actuator_gainprm, m.nu * mjNGAIN)},
               {"actuator_biasprm", List(m.actuator_biasprm, m.nu * mjNBIAS)},
               {"actuator_ctrllimited", Integers(m.actuator_ctrllimited, m.nu)},
               {"actuator_ctrlrange", List(m.actuator_ctrlrange, m.nu * 2)},
               {"actuator_forcelimited", Integers(m.actuator_forcelimited, m.nu)},
               {"actuator_forcerange", List(m.actuator_forcerange, m.nu * 2)},
               {"actuator_length0", List(m.actuator_length0, m.nu)},
               {"sensor_adr", Integers(m.sensor_adr, m.nsensor)},
               {"sensor_dim", Integers(m.sensor_dim, m.nsensor)},
               {"sensor_objtype", Integers(m.sensor_objtype, m.nsensor)},
               {"sensor_objid", Integers(m.sensor_objid, m.nsensor)},
               {"sensor_reftype", Integers(m.sensor_reftype, m.nsensor)},
               {"sensor_refid", Integers(m.sensor_refid, m.nsensor)},
               {"site_bodyid", Integers(m.site_bodyid, m.nsite)},
               {"geom_bodyid", Integers(m.geom_bodyid, m.ngeom)},
               {"body_rootid", Integers(m.body_rootid, m.nbody)}});
  return json;
}

/// Puts the joints where and as fast as the motion has them, and sets the commands.
void Move(const Subject& subject, const mjModel& m, mjData& d, int step) {
  d.time = step * m.opt.timestep;
  const auto wave = [&](int index, double phase) {
    return std::sin((0.13 + 0.017 * index) * step + index + phase);
  };
  for (int i = 0; i < m.nq; ++i) {
    d.qpos[i] = m.qpos0[i] + 0.5 * subject.stroke * wave(i, 0.0);
  }
  for (int i = 0; i < m.nv; ++i) d.qvel[i] = subject.speed * wave(i, 1.3);
  for (int i = 0; i < m.nu; ++i) d.ctrl[i] = subject.command * wave(i, 2.1);
  mj_fwdPosition(&m, &d);
  mj_fwdVelocity(&m, &d);
  mj_sensorPos(&m, &d);
  mj_sensorVel(&m, &d);
}

/// What acts on the joints by the commands.
std::vector<mjtNum> DriveForces(const mjModel& m, mjData& d) {
  mj_fwdActuation(&m, &d);
  return {d.qfrc_actuator, d.qfrc_actuator + m.nv};
}

/// A step: what is known before the effects act, and what they do.
Json StepJson(const Machine& machine, mjData& d, ActiveEffects& effects) {
  const mjModel& m = machine.plant();
  Json json = {{"time", d.time},
               {"qpos", List(d.qpos, m.nq)},
               {"qvel", List(d.qvel, m.nv)},
               {"ctrl", List(d.ctrl, m.nu)},
               {"actuator_length", List(d.actuator_length, m.nu)},
               {"actuator_velocity", List(d.actuator_velocity, m.nu)},
               {"actuator_moment", List(d.actuator_moment, m.nu * m.nv)},
               {"qfrc_passive", List(d.qfrc_passive, m.nv)},
               {"qfrc_bias", List(d.qfrc_bias, m.nv)},
               {"efc_type", Integers(d.efc_type, d.nefc)},
               {"efc_id", Integers(d.efc_id, d.nefc)},
               {"efc_frictionloss", List(d.efc_frictionloss, d.nefc)},
               {"site_xpos", List(d.site_xpos, m.nsite * 3)},
               {"site_xmat", List(d.site_xmat, m.nsite * 9)},
               {"cvel", List(d.cvel, m.nbody * 6)},
               {"subtree_com", List(d.subtree_com, m.nbody * 3)},
               {"sensordata", List(d.sensordata, m.nsensordata)}};
  const std::vector<int>& sensors = machine.sensor_addresses();
  std::vector<double> readings;
  readings.reserve(sensors.size());
  for (const int address : sensors) readings.push_back(d.sensordata[address]);
  effects.Distort(m, d, readings, d.time);
  const std::vector<mjtNum> commanded = DriveForces(m, d);
  effects.Act(m, d);
  std::vector<mjtNum> force = DriveForces(m, d);
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] += d.qfrc_applied[i] - commanded[i];
  }
  json["expected"] = {{"force", force},
                      {"drive", commanded},
                      {"bounds", List(d.efc_frictionloss, d.nefc)},
                      {"sensors", sensors},
                      {"readings", readings}};
  return json;
}

/// Where MuJoCo itself, which ignores what is not its own, moves the plant from qpos0.
Json StockMotion(const Subject& subject, const mjModel& m) {
  const DataPtr data = MakeData(m);
  Json commands = Json::array();
  for (int step = 0; step < kStockSteps; ++step) {
    for (int i = 0; i < m.nu; ++i) {
      data->ctrl[i] = subject.command * std::sin(0.13 * step + i);
    }
    commands.push_back(List(data->ctrl, m.nu));
    mj_step(&m, data.get());
  }
  return {{"commands", commands},
          {"qpos", List(data->qpos, m.nq)},
          {"qvel", List(data->qvel, m.nv)}};
}

/// Where the effects move it, by the same commands; nothing where it runs away.
Json EffectMotion(const Machine& machine, const Json& commands) {
  const mjModel& m = machine.plant();
  const DataPtr data = MakeData(m);
  ActiveEffects effects(machine.channels(), m, machine.effects());
  for (const Json& command : commands) {
    mj_step1(&m, data.get());
    const auto values = command.get<std::vector<mjtNum>>();
    std::ranges::copy(values, data->ctrl);
    effects.Act(m, *data);
    mj_step2(&m, data.get());
  }
  if (HasDiverged(*data)) return nullptr;
  return {{"commands", commands},
          {"qpos", List(data->qpos, m.nq)},
          {"qvel", List(data->qvel, m.nv)}};
}

void Write(const fs::path& folder, const Subject& subject,
           const std::vector<std::string>& effects) {
  const std::string setup = MJDIAG_SOURCE_DIR "/mjcf/" + subject.machine;
  WriteExtendedSetup(folder, setup, Machine(ReadSetup(setup)), With(effects));
  const Machine machine(ReadSetup(folder));
  const DataPtr data = MakeData(machine.plant());
  ActiveEffects active(machine.channels(), machine.plant(), machine.effects());
  Json steps = Json::array();
  for (int step = 0; step < kSteps; ++step) {
    Move(subject, machine.plant(), *data, step);
    steps.push_back(StepJson(machine, *data, active));
  }
  const ModelPtr stock = LoadModel(folder / "plant.xml");
  const Json motion = StockMotion(subject, *stock);
  WriteTextFile(folder / "stock.json", motion.dump());
  WriteTextFile(folder / "moved.json",
                EffectMotion(machine, motion["commands"]).dump());
  const Json json = {{"effects", effects},
                     {"model", ModelJson(*stock)},
                     {"prepared", Changing(machine.plant())},
                     {"steps", steps}};
  WriteTextFile(folder / "steps.json", json.dump());
}

/// Of the effects that plants carry as numerics, how many values they have.
Json CarriedEffects() {
  Json json;
  for (const Effect* effect : Effects()) {
    if (effect->form() == Form::kNumeric) {
      json[effect->name()] = effect->parameters().size();
    }
  }
  return json;
}

void WriteAll(const fs::path& folder) {
  fs::create_directories(folder);
  WriteTextFile(folder / "effects.json", CarriedEffects().dump());
  for (const Subject& subject : Subjects()) {
    int number = 0;
    for (const std::string& effect : subject.effects) {
      const std::string name = subject.machine + "_" + std::to_string(++number) + "_" +
                               effect.substr(0, effect.find('@'));
      Write(folder / name, subject, {effect});
    }
    Write(folder / (subject.machine + "_all"), subject, subject.effects);
  }
}

}  // namespace
}  // namespace mjdiag::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: extended_plants FOLDER\n", stderr);
    return 2;
  }
  try {
    mjdiag::test::WriteAll(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
