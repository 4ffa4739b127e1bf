/* A program without MuJoCo: it feeds the samples of a record, as if a real machine's
 * controller did.
 * Usage: fed <setup, or -> <filters> <linear> <record.csv> <diagnosis.json> */
#include <stdlib.h>

#include "program.h"

enum { kMost = 32, kLine = 4096 };

/* The column with that name in front of its unit. */
static int Column(const char* header, const char* name) {
  const size_t length = strlen(name);
  int column = 0;
  for (const char* at = header; at != NULL; ++column) {
    if (strncmp(at, name, length) == 0 && at[length] == ' ') return column;
    at = strchr(at, ',');
    if (at != NULL) ++at;
  }
  return -1;
}

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  const char* setup = strcmp(argv[1], "-") == 0 ? NULL : argv[1];
  mjdiag_monitor* monitor = mjdiag_monitor_open(setup, argv[2], atoi(argv[3]), 100000);
  if (monitor == NULL) return Fail("open");

  char line[kLine];
  FILE* record = fopen(argv[4], "r");
  if (record == NULL || fgets(line, sizeof line, record) == NULL) return 2;
  int columns[2][kMost];
  int count[2];
  for (int kind = MJDIAG_OUTPUT; kind <= MJDIAG_INPUT; ++kind) {
    count[kind] = mjdiag_monitor_count(monitor, (mjdiag_kind)kind);
    if (count[kind] < 0 || count[kind] > kMost) return Fail("count");
    for (int i = 0; i < count[kind]; ++i) {
      columns[kind][i] =
          Column(line, mjdiag_monitor_name(monitor, (mjdiag_kind)kind, i));
      if (columns[kind][i] < 0) return 2;
    }
  }
  while (fgets(line, sizeof line, record) != NULL) {
    double row[kMost] = {0.0};
    int column = 0;
    for (char* cell = strtok(line, ","); cell != NULL && column < kMost;
         cell = strtok(NULL, ",")) {
      row[column++] = strtod(cell, NULL);
    }
    double values[2][kMost];
    for (int kind = 0; kind < 2; ++kind) {
      for (int i = 0; i < count[kind]; ++i) {
        values[kind][i] = row[columns[kind][i]];
      }
    }
    if (mjdiag_monitor_step(monitor, values[0], count[0], values[1], count[1]) != 0) {
      return Fail("step");
    }
  }
  fclose(record);
  return Conclude(monitor, argv[5]);
}
