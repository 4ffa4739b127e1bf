/* mjdiag in other MuJoCo programs: a shared library, libmjdiag, with a C interface.
 *
 *   mjModel* m = mj_loadXML("mjcf/ab383/plant.xml", ...);
 *   mjdiag_prepare(m, "mjcf/ab383");
 *   mjData* d = mj_makeData(m);
 *   mjdiag_instance* machine = mjdiag_attach(m, d, "mjcf/ab383", NULL, 1);
 *   for (...) mj_step(m, d);               // controllers run in the control callback
 *   mjdiag_write_record(machine, "run.csv");
 *   mjdiag_detach(machine);
 *
 * Several instances may run in parallel threads, each with an mjData of its own.
 * mj_resetData ends the control of that data: detach and attach again. Functions that
 * fail return NULL or a number other than 0 and leave one line in mjdiag_last_error().
 */
#ifndef MJDIAG_H_
#define MJDIAG_H_

#include <mujoco/mujoco.h>
#include <stdint.h> /* NOLINT(modernize-deprecated-headers): for C */

#ifdef __cplusplus
extern "C" {
#endif

#define MJDIAG_API __attribute__((visibility("default")))

typedef struct mjdiag_instance mjdiag_instance; /* NOLINT(modernize-use-using) */

/* "0.1.0" */
MJDIAG_API const char* mjdiag_version(void);

/* What the last failing call of this thread has to say; never NULL. */
MJDIAG_API const char* mjdiag_last_error(void);

/* Makes the model the machine of the setup: gravity, static friction, the effects that
 * the plant carries, and room in mjData.userdata for the mark of an instance. Call
 * once, before mj_makeData. */
MJDIAG_API int mjdiag_prepare(mjModel* model, const char* setup);

/* Sets a fault parameter of the plant (1: healthy). Call before stepping. */
MJDIAG_API int mjdiag_set_fault(mjModel* model, const char* parameter, double value);

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

#ifdef __cplusplus
}
#endif

#endif /* MJDIAG_H_ */
