/* What the programs of these tests have in common. */
#ifndef MJDIAG_TESTS_PROGRAM_H_
#define MJDIAG_TESTS_PROGRAM_H_

#include <stdio.h>
#include <string.h>

#include "mjdiag.h"

static inline int Fail(const char* what) {
  fprintf(stderr, "%s: %s\n", what, mjdiag_last_error());
  return 1;
}

/* The plant of a setup, made its machine. */
static inline mjModel* LoadPlant(const char* setup) {
  char plant[1024];
  char error[512] = "";
  snprintf(plant, sizeof plant, "%s/plant.xml", setup);
  mjModel* model = mj_loadXML(plant, NULL, error, sizeof error);
  if (model == NULL) fputs(error, stderr);
  return model != NULL && mjdiag_prepare(model, setup) == 0 ? model : NULL;
}

/* Prints the verdict and writes diagnosis.json. */
static inline int Conclude(mjdiag_monitor* monitor, const char* file) {
  const char* verdict = mjdiag_monitor_conclude(monitor);
  if (verdict == NULL) return Fail("conclude");
  puts(verdict);
  if (mjdiag_monitor_write(monitor, file) != 0) return Fail("write");
  mjdiag_monitor_close(monitor);
  return 0;
}

#endif /* MJDIAG_TESTS_PROGRAM_H_ */
