/* mjdiag in other programs: a shared library, libmjdiag, with a C interface.
 *
 * Control, in any MuJoCo program:
 *
 *   mjModel* m = mj_loadXML("mjcf/ab383/plant.xml", ...);
 *   mjdiag_prepare(m, "mjcf/ab383");
 *   mjData* d = mj_makeData(m);
 *   mjdiag_instance* machine = mjdiag_attach(m, d, "mjcf/ab383", NULL, 1);
 *   for (...) mj_step(m, d);               // controllers run in the control callback
 *   mjdiag_write_record(machine, "run.csv");
 *   mjdiag_detach(machine);
 *
 * Diagnosis: a monitor is opened from a setup, gets every control tick from one of
 * three sources, and can be asked between ticks what is wrong:
 *
 *   mjdiag_monitor* monitor = mjdiag_monitor_open("mjcf/ab383", NULL, 0, ticks);
 *
 *   mjdiag_monitor_watch(monitor, machine);          // what mjdiag controls
 *
 *   mjdiag_monitor_listen(monitor, m);               // what the program controls
 *   for (...) {
 *     mj_step1(m, d);
 *     d->ctrl[...] = ...;                            // a controller of its own
 *     mjdiag_monitor_hear(monitor, m, d);
 *     mj_step2(m, d);
 *   }
 *
 *   mjdiag_monitor_step(monitor, y, 3, u, 3);        // samples of a real machine
 *
 *   puts(mjdiag_monitor_conclude(monitor));          // "Detected: zeta_x = 1.2."
 *   mjdiag_monitor_write(monitor, "diagnosis.json");
 *   mjdiag_monitor_close(monitor);
 *
 * Functions that fail return NULL or a number other than 0, and leave one line in
 * mjdiag_last_error(); counts are negative then. Null pointers, closed handles and calls
 * in the wrong order are refused in this way. Several instances and monitors may run in
 * parallel threads, each of them, and each mjData, in one thread at a time.
 *
 * mj_resetData ends the control of that data: detach and attach again. Instances are
 * detached before their mjData is deleted. A control callback of the program's own is to
 * be set before the first instance is attached or monitor opened: mjdiag passes data on
 * to it that are not under its own control.
 */
#ifndef MJDIAG_H_
#define MJDIAG_H_

#include <mujoco/mujoco.h>
#include <stdint.h> /* NOLINT(modernize-deprecated-headers): for C */

#ifdef __cplusplus
extern "C" {
#endif

#define MJDIAG_API __attribute__((visibility("default")))

/* NOLINTBEGIN(modernize-use-using): for C */
typedef struct mjdiag_instance mjdiag_instance;
typedef struct mjdiag_monitor mjdiag_monitor;

/* What the channels and faults of a monitor are numbered by, from 0. */
typedef enum mjdiag_kind {
  MJDIAG_OUTPUT, /* readings */
  MJDIAG_INPUT,  /* commands */
  MJDIAG_FAULT   /* fault parameters, then disturbances */
} mjdiag_kind;

/* What a monitor saw last. The residual is in units of its own noise. */
typedef struct mjdiag_reading {
  int64_t ticks;       /* so far; the rest is of the last of them */
  double residual;     /* near 0 on a healthy machine */
  double residual_min; /* its limits */
  double residual_max;
  double integral;        /* mean of its magnitude over a window */
  double integral_max;    /* the limit */
  int residual_alarm;     /* 1: the residual is outside its limits now */
  int lasting_alarm;      /* 1: the integral is, no passing disturbance */
  double first_detection; /* when the residual first was [s], NaN: never */
  double lasting_since;   /* when the integral first was [s], NaN: never */
} mjdiag_reading;
/* NOLINTEND(modernize-use-using) */

/* "0.1.0" */
MJDIAG_API const char* mjdiag_version(void);

/* What the last failing call of this thread has to say; never NULL. */
MJDIAG_API const char* mjdiag_last_error(void);

/* ---- control ---- */

/* Makes the model the machine of the setup: gravity, static friction, the effects that
 * the plant carries, and room in mjData.userdata for the mark of an instance. Call
 * once, before mj_makeData; a second call is refused. */
MJDIAG_API int mjdiag_prepare(mjModel* model, const char* setup);

/* Sets a fault parameter of the plant (1: healthy). Call before stepping. */
MJDIAG_API int mjdiag_set_fault(mjModel* model, const char* parameter, double value);

/* Resets the data and puts the machine at rest without input, for programs with
 * controllers of their own. The model must be prepared. */
MJDIAG_API int mjdiag_rest(const mjModel* model, mjData* data, const char* setup);

/* Resets the data, puts the machine at rest at the start of a trajectory of the setup
 * (NULL: its default) and lets its controllers drive it. The model must be prepared and
 * its time step the one of the setup. */
MJDIAG_API mjdiag_instance* mjdiag_attach(const mjModel* model, mjData* data,
                                          const char* setup, const char* trajectory,
                                          uint64_t seed);

/* Control ticks done so far. */
MJDIAG_API int64_t mjdiag_ticks(const mjdiag_instance* instance);

/* Writes the record so far: CSV, or MAT v5 if the name ends in ".mat". */
MJDIAG_API int mjdiag_write_record(const mjdiag_instance* instance, const char* file);

/* Ends the control, sets the machine's actuators to zero and frees the instance. */
MJDIAG_API void mjdiag_detach(mjdiag_instance* instance);

/* ---- diagnosis ---- */

/* Opens a monitor of the healthy machine of a setup.
 * setup    folder or file. NULL: filters alone; faults come from the residuals then,
 *          told apart less well than by the twin that runs beside the machine
 * filters  filters.json of `mjdiag design`. NULL: designed now, with limits from
 *          simulated healthy runs, which takes seconds
 * linear   1: the machine is taken as linear, without dry friction, as by `mjdiag
 *          simulate --linear --diagnose`; else 0
 * room     ticks of the longest run that is to be concluded. A monitor runs for as long
 *          as it likes in the memory that it has; what a conclusion says of a run as a
 *          whole (extremes, tones) needs some for every tick. 0: none are concluded */
MJDIAG_API mjdiag_monitor* mjdiag_monitor_open(const char* setup, const char* filters,
                                               int linear, int64_t room);

/* Number, and names, of the channels and faults of a monitor. */
MJDIAG_API int mjdiag_monitor_count(const mjdiag_monitor* monitor, mjdiag_kind kind);
MJDIAG_API const char* mjdiag_monitor_name(const mjdiag_monitor* monitor,
                                           mjdiag_kind kind, int index);

/* The control tick [s]; negative if it fails. */
MJDIAG_API double mjdiag_monitor_sample_time(const mjdiag_monitor* monitor);

/* A monitor has one of three sources of ticks, till it is restarted. It wants every
 * tick: with one that is missing, or has a number that is not finite, its run ends. What
 * follows is refused, what was seen can be read and concluded. None of the functions for
 * a tick allocates, locks or does I/O. */

/* What an instance reads and commands, from its next tick on. */
MJDIAG_API int mjdiag_monitor_watch(mjdiag_monitor* monitor, mjdiag_instance* instance);

/* What a program that has its own controllers reads and commands: the sensors and
 * controls in its mjData that are the channels of the setup. The model must be prepared
 * and its time step the one of the setup. */
MJDIAG_API int mjdiag_monitor_listen(mjdiag_monitor* monitor, const mjModel* model);
/* To be called when sensors are read and controls are set: between mj_step1 and
 * mj_step2, or at the end of the program's control callback; in the first physics step of
 * every control tick, or in all of them: those within a tick are passed over. */
MJDIAG_API int mjdiag_monitor_hear(mjdiag_monitor* monitor, const mjModel* model,
                                   const mjData* data);

/* Samples without MuJoCo: readings y and commands u of a tick, in SI units, in the
 * order of the channels. */
MJDIAG_API int mjdiag_monitor_step(mjdiag_monitor* monitor, const double* y,
                                   int outputs, const double* u, int inputs);

/* What it saw last. Does not allocate. */
MJDIAG_API int mjdiag_monitor_read(const mjdiag_monitor* monitor,
                                   mjdiag_reading* reading);

/* What it takes the faults for now: fault parameters (1: healthy) and magnitudes of
 * disturbances (0: healthy), and their standard deviations (NULL: not wanted; NaN as
 * long as there are none, and always without a setup). Does not allocate.
 * faults   length of the arrays, mjdiag_monitor_count(monitor, MJDIAG_FAULT) */
MJDIAG_API int mjdiag_monitor_estimates(const mjdiag_monitor* monitor, double* values,
                                        double* sd, int faults);

/* Which faults it names now, 1 or 0 for each: by a criterion on all of them together.
 * Allocates. */
MJDIAG_API int mjdiag_monitor_named(const mjdiag_monitor* monitor, int* named,
                                    int faults);

/* Ends the run: the verdict in one sentence, as `mjdiag simulate --diagnose` prints it,
 * valid till the monitor is restarted or closed. Fails for a run longer than the room, too
 * short for its spectrum, or with a motion that does not tell the faults apart. */
MJDIAG_API const char* mjdiag_monitor_conclude(mjdiag_monitor* monitor);

/* Writes diagnosis.json of a run that is concluded. */
MJDIAG_API int mjdiag_monitor_write(const mjdiag_monitor* monitor, const char* file);

/* Makes it ready for another run, from any source. */
MJDIAG_API int mjdiag_monitor_restart(mjdiag_monitor* monitor);

MJDIAG_API void mjdiag_monitor_close(mjdiag_monitor* monitor);

#ifdef __cplusplus
}
#endif

#endif /* MJDIAG_H_ */
