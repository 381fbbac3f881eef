/* FMI 3.0: Model Exchange and Co-Simulation. The types are those of fmi3FunctionTypes.h. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "solid.h"

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, double, bool, bool, bool,
                                               bool, bool *, double *);
typedef void (*fmi3Callback)(void);

typedef struct {
    Solid solid;
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
} Instance;

#if defined(_WIN32)
#define VISIBLE __declspec(dllexport)
#elif defined(__GNUC__)
#define VISIBLE __attribute__((visibility("default")))
#else
#define VISIBLE
#endif
#define JOIN(a, b) a##b
#define PASTE(a, b) JOIN(a, b)
#ifdef FMI3_FUNCTION_PREFIX /* where sources are linked into a program */
#define EXPORT(type, name) VISIBLE type PASTE(FMI3_FUNCTION_PREFIX, name)
#else
#define EXPORT(type, name) VISIBLE type name
#endif
#define UNUSED(name) (void)(name)

static fmi3Status report(Instance *i, fmi3Status status, const char *text) {
    if (i && i->log)
        i->log(i->environment, status,
               status == fmi3Error ? "logStatusError" : "logStatusDiscard", text);
    return status;
}

static fmi3Status as_status(Instance *i, int outcome, unsigned reference) {
    char text[160];
    if (outcome == DONE) return fmi3OK;
    snprintf(text, sizeof text, "value reference %u: %s", reference,
             outcome == OUTSIDE_LIMITS ? "the value is outside its limits or not finite"
             : outcome == LOCKED       ? "is set before the initialisation ends, not later"
                                       : "there is no such variable, or it cannot be set");
    return report(i, outcome == OUTSIDE_LIMITS ? fmi3Discard : fmi3Error, text);
}

static fmi3Instance instantiate(fmi3String token, fmi3InstanceEnvironment environment,
                                fmi3LogMessageCallback log, int exchange) {
    Instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    i->log = log, i->environment = environment;
    if (!token || strcmp(token, TOKEN)) {
        report(i, fmi3Error, "the token is not that of this FMU: binary and description differ");
        free(i);
        return NULL;
    }
    start_solid(&i->solid, exchange);
    return i;
}

EXPORT(const char *, fmi3GetVersion)(void) { return "3.0"; }

EXPORT(fmi3Status, fmi3SetDebugLogging)
(fmi3Instance c, bool on, size_t n, const fmi3String categories[]) {
    UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(categories);
    return fmi3OK;
}

EXPORT(fmi3Instance, fmi3InstantiateModelExchange)
(fmi3String name, fmi3String token, fmi3String path, bool visible, bool logging,
 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    UNUSED(name), UNUSED(path), UNUSED(visible), UNUSED(logging);
    return instantiate(token, environment, log, 1);
}

EXPORT(fmi3Instance, fmi3InstantiateCoSimulation)
(fmi3String name, fmi3String token, fmi3String path, bool visible, bool logging, bool events,
 bool early, const fmi3ValueReference intermediate[], size_t n,
 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
 fmi3IntermediateUpdateCallback update) {
    UNUSED(name), UNUSED(path), UNUSED(visible), UNUSED(logging), UNUSED(events), UNUSED(early);
    UNUSED(intermediate), UNUSED(n), UNUSED(update);
    return instantiate(token, environment, log, 0);
}

EXPORT(fmi3Instance, fmi3InstantiateScheduledExecution)
(fmi3String name, fmi3String token, fmi3String path, bool visible, bool logging,
 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3Callback update,
 fmi3Callback lock, fmi3Callback unlock) {
    UNUSED(name), UNUSED(token), UNUSED(path), UNUSED(visible), UNUSED(logging);
    UNUSED(environment), UNUSED(log), UNUSED(update), UNUSED(lock), UNUSED(unlock);
    return NULL;
}

EXPORT(void, fmi3FreeInstance)(fmi3Instance c) { free(c); }

EXPORT(fmi3Status, fmi3EnterInitializationMode)
(fmi3Instance c, bool given, double tolerance, double start, bool ends, double stop) {
    UNUSED(given), UNUSED(tolerance), UNUSED(ends), UNUSED(stop);
    ((Instance *)c)->solid.time = start;
    ((Instance *)c)->solid.stage = INITIALISATION;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3ExitInitializationMode)(fmi3Instance c) {
    finish_initialisation(&((Instance *)c)->solid);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3Terminate)(fmi3Instance c) {
    ((Instance *)c)->solid.stage = TERMINATED;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3Reset)(fmi3Instance c) {
    Instance *i = c;
    start_solid(&i->solid, i->solid.exchange);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetFloat64)
(fmi3Instance c, const fmi3ValueReference references[], size_t n, double values[], size_t size) {
    Instance *i = c;
    if (size != n) return report(i, fmi3Error, "all variables are scalars");
    for (size_t at = 0; at < n; at++) {
        int outcome = read_variable(&i->solid, references[at], values + at);
        if (outcome) return as_status(i, outcome, references[at]);
    }
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SetFloat64)
(fmi3Instance c, const fmi3ValueReference references[], size_t n, const double values[],
 size_t size) {
    Instance *i = c;
    if (size != n) return report(i, fmi3Error, "all variables are scalars");
    for (size_t at = 0; at < n; at++) {
        int outcome = write_variable(&i->solid, references[at], values[at]);
        if (outcome) return as_status(i, outcome, references[at]);
    }
    return fmi3OK;
}

/* All variables are Float64: there is none of another type to read or set. */
#define NONE_OF(type, ctype)                                                                      \
    EXPORT(fmi3Status, fmi3Get##type)                                                             \
    (fmi3Instance c, const fmi3ValueReference r[], size_t n, ctype values[], size_t size) {       \
        UNUSED(values), UNUSED(size);                                                             \
        return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;                                          \
    }                                                                                             \
    EXPORT(fmi3Status, fmi3Set##type)                                                             \
    (fmi3Instance c, const fmi3ValueReference r[], size_t n, const ctype values[], size_t size) { \
        UNUSED(values), UNUSED(size);                                                             \
        return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;                                          \
    }
NONE_OF(Float32, float)
NONE_OF(Int8, int8_t)
NONE_OF(UInt8, uint8_t)
NONE_OF(Int16, int16_t)
NONE_OF(UInt16, uint16_t)
NONE_OF(Int32, int32_t)
NONE_OF(UInt32, uint32_t)
NONE_OF(Int64, int64_t)
NONE_OF(UInt64, uint64_t)
NONE_OF(Boolean, bool)
NONE_OF(String, fmi3String)

EXPORT(fmi3Status, fmi3GetBinary)
(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary values[],
 size_t size) {
    UNUSED(sizes), UNUSED(values), UNUSED(size);
    return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;
}

EXPORT(fmi3Status, fmi3SetBinary)
(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t sizes[],
 const fmi3Binary values[], size_t size) {
    UNUSED(sizes), UNUSED(values), UNUSED(size);
    return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;
}

EXPORT(fmi3Status, fmi3GetClock)
(fmi3Instance c, const fmi3ValueReference r[], size_t n, bool values[]) {
    UNUSED(values);
    return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;
}

EXPORT(fmi3Status, fmi3SetClock)
(fmi3Instance c, const fmi3ValueReference r[], size_t n, const bool values[]) {
    UNUSED(values);
    return n ? as_status(c, UNKNOWN, r[0]) : fmi3OK;
}

EXPORT(fmi3Status, fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state) {
    if (!*state) *state = malloc(sizeof(Solid));
    if (!*state) return report(c, fmi3Error, "no memory for the state");
    memcpy(*state, &((Instance *)c)->solid, sizeof(Solid));
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state) {
    memcpy(&((Instance *)c)->solid, state, sizeof(Solid));
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state) {
    UNUSED(c);
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size) {
    UNUSED(c), UNUSED(state);
    *size = sizeof(Solid);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SerializeFMUState)
(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    if (size < sizeof(Solid)) return report(c, fmi3Error, "too small for the state");
    memcpy(bytes, state, sizeof(Solid));
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3DeserializeFMUState)
(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    if (size != sizeof(Solid) || memcmp(bytes + offsetof(Solid, token), TOKEN, sizeof TOKEN))
        return report(c, fmi3Error, "this is not a state of this FMU");
    if (!*state) *state = malloc(sizeof(Solid));
    if (!*state) return report(c, fmi3Error, "no memory for the state");
    memcpy(*state, bytes, size);
    return fmi3OK;
}

/* What this FMU has not: its description offers none of it. */
#define NOTHING(name, arguments)                                                                  \
    EXPORT(fmi3Status, name) arguments { return report(c, fmi3Error, #name ": not offered"); }
typedef const fmi3ValueReference *References;
NOTHING(fmi3GetNumberOfVariableDependencies,
        (fmi3Instance c, fmi3ValueReference r, size_t *n))
NOTHING(fmi3GetVariableDependencies,
        (fmi3Instance c, fmi3ValueReference r, size_t *i, fmi3ValueReference *k, size_t *j,
         int *kinds, size_t n))
NOTHING(fmi3GetDirectionalDerivative,
        (fmi3Instance c, References u, size_t nu, References k, size_t nk, const double *seed,
         size_t ns, double *found, size_t nf))
NOTHING(fmi3GetAdjointDerivative,
        (fmi3Instance c, References u, size_t nu, References k, size_t nk, const double *seed,
         size_t ns, double *found, size_t nf))
NOTHING(fmi3EnterConfigurationMode, (fmi3Instance c))
NOTHING(fmi3ExitConfigurationMode, (fmi3Instance c))
NOTHING(fmi3GetIntervalDecimal, (fmi3Instance c, References r, size_t n, double *v, int *q))
NOTHING(fmi3GetIntervalFraction,
        (fmi3Instance c, References r, size_t n, uint64_t *v, uint64_t *w, int *q))
NOTHING(fmi3GetShiftDecimal, (fmi3Instance c, References r, size_t n, double *v))
NOTHING(fmi3GetShiftFraction, (fmi3Instance c, References r, size_t n, uint64_t *v, uint64_t *w))
NOTHING(fmi3SetIntervalDecimal, (fmi3Instance c, References r, size_t n, const double *v))
NOTHING(fmi3SetIntervalFraction,
        (fmi3Instance c, References r, size_t n, const uint64_t *v, const uint64_t *w))
NOTHING(fmi3SetShiftDecimal, (fmi3Instance c, References r, size_t n, const double *v))
NOTHING(fmi3SetShiftFraction,
        (fmi3Instance c, References r, size_t n, const uint64_t *v, const uint64_t *w))
NOTHING(fmi3GetOutputDerivatives,
        (fmi3Instance c, References r, size_t n, const int32_t *order, double *v, size_t nv))
NOTHING(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, double time))

EXPORT(fmi3Status, fmi3EnterEventMode)(fmi3Instance c) { UNUSED(c); return fmi3OK; }
EXPORT(fmi3Status, fmi3EnterStepMode)(fmi3Instance c) { UNUSED(c); return fmi3OK; }
EXPORT(fmi3Status, fmi3EvaluateDiscreteStates)(fmi3Instance c) { UNUSED(c); return fmi3OK; }

EXPORT(fmi3Status, fmi3UpdateDiscreteStates)
(fmi3Instance c, bool *again, bool *terminate, bool *nominals, bool *values, bool *next,
 double *time) {
    UNUSED(c), UNUSED(time);
    *again = *terminate = *nominals = *values = *next = false;
    return fmi3OK;
}

/* Model Exchange */

EXPORT(fmi3Status, fmi3EnterContinuousTimeMode)(fmi3Instance c) { UNUSED(c); return fmi3OK; }

EXPORT(fmi3Status, fmi3CompletedIntegratorStep)
(fmi3Instance c, bool keep, bool *event, bool *terminate) {
    UNUSED(c), UNUSED(keep);
    *event = *terminate = false;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SetTime)(fmi3Instance c, double time) {
    ((Instance *)c)->solid.time = time;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SetContinuousStates)(fmi3Instance c, const double x[], size_t n) {
    if (n != STATES) return report(c, fmi3Error, "wrong number of states");
    memcpy(((Instance *)c)->solid.state, x, n * sizeof *x);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetContinuousStates)(fmi3Instance c, double x[], size_t n) {
    if (n != STATES) return report(c, fmi3Error, "wrong number of states");
    memcpy(x, ((Instance *)c)->solid.state, n * sizeof *x);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetContinuousStateDerivatives)(fmi3Instance c, double derivatives[],
                                                      size_t n) {
    double all[STATES + 1];
    if (n != STATES) return report(c, fmi3Error, "wrong number of states");
    find_derivatives(&((Instance *)c)->solid, all);
    memcpy(derivatives, all, n * sizeof *all);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetEventIndicators)(fmi3Instance c, double indicators[], size_t n) {
    UNUSED(indicators);
    return n ? report(c, fmi3Error, "this FMU has no event indicators") : fmi3OK;
}

EXPORT(fmi3Status, fmi3GetNominalsOfContinuousStates)(fmi3Instance c, double x[], size_t n) {
    UNUSED(c);
    for (size_t at = 0; at < n; at++) x[at] = 1;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *n) {
    UNUSED(c);
    *n = 0;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *n) {
    UNUSED(c);
    *n = STATES;
    return fmi3OK;
}

/* Co-Simulation */

EXPORT(fmi3Status, fmi3DoStep)
(fmi3Instance c, double time, double step, bool keep, bool *event, bool *terminate, bool *early,
 double *last) {
    Instance *i = c;
    UNUSED(keep);
    *event = *terminate = *early = false;
    *last = i->solid.time;
    if (i->solid.stage != RUNNING || advance(&i->solid, time, step))
        return report(i, fmi3Error, "the step is negative, not finite or not in its place");
    *last = i->solid.time;
    return fmi3OK;
}
