/* A program with a controller and a loop of its own, to which mjdiag only listens. Its
 * encoders have noise if it is told so.
 * Usage: own_loop <setup> <filters> <fault> <value> <noise> <loop> <record.csv>
 *                 <diagnosis.json>, where loop is "steps": mj_step1 and mj_step2, or
 *                 "callback": mj_step with a control callback */
#include <math.h>
#include <stdlib.h>

#include "program.h"

enum { kTicks = 4000, kSubsteps = 4, kAxes = 3 };
static const double kTick = 1.0 / 8000.0;
static const double kPi = 3.14159265358979323846;

static const mjModel* machine;
static mjdiag_monitor* monitor;
static FILE* record;
static double noise;
static int step;
static int strangers;
static int refused;

/* Sums of even numbers are normal enough. */
static double Normal(void) {
  static uint64_t state = 1;
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    sum += (double)(state >> 11) / 9007199254740992.0;
  }
  return sum;
}

/* There and back, every axis at a pace of its own. */
static double Reference(int axis, double time) {
  static const double way[kAxes] = {0.004, 0.003, 0.02};
  static const double period[kAxes] = {0.05, 0.04, 0.03};
  return 0.5 * way[axis] * (1.0 - cos(2.0 * kPi * time / period[axis]));
}

/* Proportional and derivative. */
static double Command(int axis, double time, double reading) {
  static const double proportional[kAxes] = {5.3e5, 2.9e5, 28.0};
  static const double derivative[kAxes] = {1950.0, 1055.0, 0.1};
  static double last[kAxes];
  const double error = Reference(axis, time) - reading;
  const double slope = (error - last[axis]) / kTick;
  last[axis] = error;
  return proportional[axis] * error + derivative[axis] * slope;
}

/* When positions and velocities of a step are known. */
static void Control(const mjModel* model, mjData* data) {
  static double command[kAxes];
  static const char* const sensors[kAxes] = {"x_encoder", "y_encoder", "z_encoder"};
  static const int components[kAxes] = {0, 1, 0};
  if (model != machine) {
    ++strangers;
    return;
  }
  if (step++ % kSubsteps == 0) {
    double reading[kAxes];
    for (int axis = 0; axis < kAxes; ++axis) {
      const int sensor = mj_name2id(model, mjOBJ_SENSOR, sensors[axis]);
      double* where = &data->sensordata[model->sensor_adr[sensor] + components[axis]];
      if (noise > 0.0) *where += noise * Normal();
      reading[axis] = *where;
      command[axis] = Command(axis, data->time, reading[axis]);
    }
    fprintf(record, "%.17g", kTick * (step / kSubsteps));
    for (int axis = 0; axis < kAxes; ++axis) fprintf(record, ",%.17g", reading[axis]);
    for (int axis = 0; axis < kAxes; ++axis) fprintf(record, ",%.17g", command[axis]);
    fprintf(record, "\n");
  }
  for (int axis = 0; axis < kAxes; ++axis) data->ctrl[axis] = command[axis];
  if (mjdiag_monitor_hear(monitor, model, data) != 0) ++refused;
}

int main(int argc, char** argv) {
  if (argc != 9) return 2;
  noise = atof(argv[5]);
  const int in_callback = strcmp(argv[6], "callback") == 0;
  mjModel* model = LoadPlant(argv[1]);
  if (model == NULL) return Fail("load");
  machine = model;
  if (mjdiag_set_fault(model, argv[3], atof(argv[4])) != 0) return Fail("set fault");
  mjData* data = mj_makeData(model);
  if (mjdiag_rest(model, data, argv[1]) != 0) return Fail("rest");
  record = fopen(argv[7], "w");
  if (record == NULL) return 2;
  fprintf(record, "time [s],x [m],y [m],z [rad],u_x [N],u_y [N],u_z [N m]\n");

  if (in_callback) mjcb_control = Control;
  monitor = mjdiag_monitor_open(argv[1], argv[2], 0, kTicks);
  if (monitor == NULL) return Fail("open");
  if (mjdiag_monitor_listen(monitor, model) != 0) return Fail("listen");
  for (int i = 0; i < kTicks * kSubsteps; ++i) {
    if (in_callback) {
      mj_step(model, data);
    } else {
      mj_step1(model, data);
      Control(model, data);
      mj_step2(model, data);
    }
  }
  fclose(record);
  if (refused > 0) return Fail("hear");
  if (step != kTicks * kSubsteps || strangers > 0) {
    fprintf(stderr, "controlled %d times, and others' data %d times\n", step,
            strangers);
    return 1;
  }
  const int failed = Conclude(monitor, argv[8]);
  mj_deleteData(data);
  mj_deleteModel(model);
  return failed;
}
