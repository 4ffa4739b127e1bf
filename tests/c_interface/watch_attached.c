/* A program that lets mjdiag control the machine and watch it.
 * Usage: watch_attached <setup> <filters> <trajectory> <fault> <value> <diagnosis.json> */
#include <stdlib.h>

#include "program.h"

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  const int ticks = 4000;
  mjModel* model = LoadPlant(argv[1]);
  if (model == NULL) return Fail("load");
  if (mjdiag_set_fault(model, argv[4], atof(argv[5])) != 0) return Fail("set fault");
  mjData* data = mj_makeData(model);
  mjdiag_instance* machine = mjdiag_attach(model, data, argv[1], argv[3], 1);
  if (machine == NULL) return Fail("attach");
  mjdiag_monitor* monitor = mjdiag_monitor_open(argv[1], argv[2], 0, ticks);
  if (monitor == NULL) return Fail("open");
  if (mjdiag_monitor_watch(monitor, machine) != 0) return Fail("watch");
  for (int i = 0; i < 4 * ticks; ++i) mj_step(model, data);
  mjdiag_detach(machine);
  const int failed = Conclude(monitor, argv[6]);
  mj_deleteData(data);
  mj_deleteModel(model);
  return failed;
}
