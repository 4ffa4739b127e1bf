/* An arm under a controller of its own: torques of a PD on top of what holds its posture and
   moves its masses (from a model of the controller's own), at a control rate, with several
   physics steps between. Not by mjdiag, so that nothing is shared with what is to be tried.

   arm TRUE.xml BELIEVED.xml MOTION SECONDS RATE SUBSTEPS SEED >record.csv
   MOTION: a line for each joint: rest kp kd, then amplitude, frequency [Hz] and phase of sines. */

#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kMostJoints = 16, kMostSines = 8 };

static struct {
  double rest, kp, kd;
  int sines;
  double amplitude[kMostSines], frequency[kMostSines], phase[kMostSines];
} joint[kMostJoints];

static double Gauss(void) {
  const double u = (rand() + 1.0) / (RAND_MAX + 2.0), v = rand() / (RAND_MAX + 1.0);
  return sqrt(-2.0 * log(u)) * cos(2.0 * mjPI * v);
}

static mjModel* Load(const char* file) {
  char error[500] = "";
  mjModel* model = mj_loadXML(file, NULL, error, sizeof error);
  if (!model) {
    fprintf(stderr, "%s: %s\n", file, error);
    exit(2);
  }
  return model;
}

/* Position, velocity and acceleration that joint i shall have; the sines rise in a second. */
static void Wanted(int i, double t, double* q, double* v, double* a) {
  const double w0 = t < 1.0 ? mjPI : 0.0;
  const double s = t < 1.0 ? 0.5 - 0.5 * cos(mjPI * t) : 1.0;
  const double ds = 0.5 * w0 * sin(w0 * t), dds = 0.5 * w0 * w0 * (w0 > 0 ? cos(w0 * t) : 0.0);
  double x = 0, dx = 0, ddx = 0;
  for (int k = 0; k < joint[i].sines; ++k) {
    const double w = 2.0 * mjPI * joint[i].frequency[k], p = w * t + joint[i].phase[k];
    x += joint[i].amplitude[k] * (sin(p) - sin(joint[i].phase[k]));
    dx += joint[i].amplitude[k] * w * cos(p);
    ddx -= joint[i].amplitude[k] * w * w * sin(p);
  }
  *q = joint[i].rest + s * x;
  *v = ds * x + s * dx;
  *a = dds * x + 2.0 * ds * dx + s * ddx;
}

static void ReadMotion(const char* file, int joints) {
  FILE* motion = fopen(file, "r");
  char line[2000];
  for (int i = 0; i < joints; ++i) {
    if (!motion || !fgets(line, sizeof line, motion)) {
      fprintf(stderr, "%s: expected a line for each of %d joints\n", file, joints);
      exit(2);
    }
    char* at = line;
    joint[i].rest = strtod(at, &at);
    joint[i].kp = strtod(at, &at);
    joint[i].kd = strtod(at, &at);
    for (int k = 0; k < kMostSines; ++k) {
      char* before = at;
      joint[i].amplitude[k] = strtod(at, &at);
      if (at == before) break;
      joint[i].frequency[k] = strtod(at, &at);
      joint[i].phase[k] = strtod(at, &at);
      joint[i].sines = k + 1;
    }
  }
  fclose(motion);
}

int main(int argc, char** argv) {
  if (argc != 8) {
    fprintf(stderr, "arm TRUE.xml BELIEVED.xml MOTION SECONDS RATE SUBSTEPS SEED\n");
    return 2;
  }
  mjModel* model = Load(argv[1]);
  mjModel* believed = Load(argv[2]);
  const double seconds = atof(argv[4]), rate = atof(argv[5]);
  const int substeps = atoi(argv[6]), n = model->nu;
  srand((unsigned)atoi(argv[7]));
  if (n > kMostJoints) return 2;
  ReadMotion(argv[3], n);
  model->opt.timestep = 1.0 / (rate * substeps);
  mjData* data = mj_makeData(model);
  mjData* belief = mj_makeData(believed);
  for (int i = 0; i < n; ++i) data->qpos[i] = joint[i].rest;

  printf("time [s]");
  for (int i = 1; i <= n; ++i) printf(",q%d [rad]", i);
  for (int i = 1; i <= n; ++i) printf(",tau%d [N m]", i);
  printf("\n");
  const int ticks = (int)lround(seconds * rate);
  /* Velocity from the readings, as controllers have it: behind a first order of 30 Hz. */
  double read[kMostJoints], before[kMostJoints], speed[kMostJoints] = {0};
  const double fresh = 1.0 - exp(-2.0 * mjPI * 30.0 / rate);
  for (int t = 0; t < ticks; ++t) {
    for (int i = 0; i < n; ++i) {
      Wanted(i, t / rate, &belief->qpos[i], &belief->qvel[i], &belief->qacc[i]);
      read[i] = data->qpos[i] + 2e-5 * Gauss();
      if (t == 0) before[i] = read[i];
    }
    mj_inverse(believed, belief);
    printf("%.6f", t / rate);
    for (int i = 0; i < n; ++i) printf(",%.9g", read[i]);
    for (int i = 0; i < n; ++i) {
      speed[i] += fresh * ((read[i] - before[i]) * rate - speed[i]);
      data->ctrl[i] = belief->qfrc_inverse[i] + joint[i].kp * (belief->qpos[i] - read[i]) +
                      joint[i].kd * (belief->qvel[i] - speed[i]);
      before[i] = read[i];
      printf(",%.9g", data->ctrl[i] + 0.01 * Gauss());
    }
    printf("\n");
    for (int s = 0; s < substeps; ++s) mj_step(model, data);
  }
  return 0;
}
