/* A C program that knows MuJoCo and mjdiag's C interface and nothing else: it loads the
 * bonder, lets mjdiag control it inside its own mj_step loop and writes the record.
 * Usage: drive_bonder <folder of the setup> <record> */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mjdiag.h"

static int Fail(const char* what) {
  fprintf(stderr, "%s: %s\n", what, mjdiag_last_error());
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  char plant[1024];
  char error[512] = "";
  snprintf(plant, sizeof plant, "%s/plant.xml", argv[1]);
  mjModel* model = mj_loadXML(plant, NULL, error, sizeof error);
  if (model == NULL) return Fail(error);

  /* Without room in userdata it must refuse, and say so. */
  mjData* data = mj_makeData(model);
  if (mjdiag_attach(model, data, argv[1], "x", 1) != NULL) return Fail("attached");
  if (strstr(mjdiag_last_error(), "nuserdata") == NULL) return Fail("no reason");
  mj_deleteData(data);
  if (mjdiag_prepare(model, NULL) == 0) return Fail("prepared from nothing");
  if (mjdiag_prepare(model, argv[1]) != 0) return Fail("prepare");
  data = mj_makeData(model);

  if (mjdiag_set_fault(model, "no_such_parameter", 1.1) == 0)
    return Fail("unknown parameter");
  if (mjdiag_set_fault(model, "zeta_x", 1.1) != 0) return Fail("set fault");
  if (mjdiag_attach(model, data, argv[1], "moonwalk", 1) != NULL)
    return Fail("moonwalk");
  mjdiag_instance* machine = mjdiag_attach(model, data, argv[1], "x", 1);
  if (machine == NULL) return Fail("attach");

  const int x = model->jnt_qposadr[mj_name2id(model, mjOBJ_JOINT, "X")];
  double furthest = 0.0;
  for (int i = 0; i < 3200; ++i) {
    mj_step(model, data);
    furthest = fmax(furthest, fabs(data->qpos[x]));
  }
  if (mjdiag_ticks(machine) != 800) return Fail("ticks");
  if (fabs(furthest - 0.004) > 20e-6) return Fail("did not travel 4 mm");
  if (mjdiag_write_record(machine, argv[2]) != 0) return Fail("write record");
  if (mjdiag_write_record(machine, "/no/such/folder/r.csv") == 0) return Fail("wrote");
  mjdiag_detach(machine);
  for (int i = 0; i < model->nu; ++i) {
    if (data->ctrl[i] != 0.0) return Fail("controls left on");
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  puts(mjdiag_version());
  return 0;
}
