/* FMI 2.0: Model Exchange and Co-Simulation. The types are those of fmi2FunctionTypes.h. */

#include <stddef.h>
#include "solid.h"

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean, fmi2Type, fmi2StatusKind;
typedef char fmi2Byte;
typedef const char *fmi2String;
typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String,
                                   fmi2String, ...);
typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

typedef struct {
    Solid solid;
    fmi2CallbackFunctions callbacks;
    char name[256];
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
#ifdef FMI2_FUNCTION_PREFIX /* where sources are linked into a program */
#define EXPORT(type, name) VISIBLE type PASTE(FMI2_FUNCTION_PREFIX, name)
#else
#define EXPORT(type, name) VISIBLE type name
#endif
#define UNUSED(name) (void)(name)

static fmi2Status report(Instance *i, fmi2Status status, const char *text) {
    if (i && i->callbacks.logger)
        i->callbacks.logger(i->callbacks.componentEnvironment, i->name, status,
                            status == fmi2Error ? "logStatusError" : "logStatusDiscard", "%s", text);
    return status;
}

static fmi2Status as_status(Instance *i, int outcome, unsigned reference) {
    char text[160];
    if (outcome == DONE) return fmi2OK;
    snprintf(text, sizeof text, "value reference %u: %s", reference,
             outcome == OUTSIDE_LIMITS ? "the value is outside its limits or not finite"
             : outcome == LOCKED       ? "is set before the initialisation ends, not later"
                                       : "there is no such variable, or it cannot be set");
    return report(i, outcome == OUTSIDE_LIMITS ? fmi2Discard : fmi2Error, text);
}

EXPORT(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT(const char *, fmi2GetVersion)(void) { return "2.0"; }

EXPORT(fmi2Component, fmi2Instantiate)
(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
 const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    UNUSED(location), UNUSED(visible), UNUSED(logging);
    Instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    if (callbacks) i->callbacks = *callbacks;
    if (name) strncpy(i->name, name, sizeof i->name - 1);
    if (!guid || strcmp(guid, TOKEN)) {
        report(i, fmi2Error, "the guid is not that of this FMU: binary and description differ");
        free(i);
        return NULL;
    }
    start_solid(&i->solid, type == 0);
    return i;
}

EXPORT(void, fmi2FreeInstance)(fmi2Component c) { free(c); }

EXPORT(fmi2Status, fmi2SetDebugLogging)
(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(categories);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetupExperiment)
(fmi2Component c, fmi2Boolean given, fmi2Real tolerance, fmi2Real start, fmi2Boolean ends,
 fmi2Real stop) {
    UNUSED(given), UNUSED(tolerance), UNUSED(ends), UNUSED(stop);
    ((Instance *)c)->solid.time = start;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2EnterInitializationMode)(fmi2Component c) {
    ((Instance *)c)->solid.stage = INITIALISATION;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2ExitInitializationMode)(fmi2Component c) {
    finish_initialisation(&((Instance *)c)->solid);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2Terminate)(fmi2Component c) {
    ((Instance *)c)->solid.stage = TERMINATED;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2Reset)(fmi2Component c) {
    Instance *i = c;
    start_solid(&i->solid, i->solid.exchange);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetReal)
(fmi2Component c, const fmi2ValueReference references[], size_t n, fmi2Real values[]) {
    Instance *i = c;
    for (size_t at = 0; at < n; at++) {
        int outcome = read_variable(&i->solid, references[at], values + at);
        if (outcome) return as_status(i, outcome, references[at]);
    }
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetReal)
(fmi2Component c, const fmi2ValueReference references[], size_t n, const fmi2Real values[]) {
    Instance *i = c;
    for (size_t at = 0; at < n; at++) {
        int outcome = write_variable(&i->solid, references[at], values[at]);
        if (outcome) return as_status(i, outcome, references[at]);
    }
    return fmi2OK;
}

/* All variables are real: there is none of another type to read or set. */
#define NONE_OF(type, ctype)                                                                      \
    EXPORT(fmi2Status, fmi2Get##type)                                                             \
    (fmi2Component c, const fmi2ValueReference r[], size_t n, ctype values[]) {                   \
        UNUSED(values);                                                                           \
        return n ? as_status(c, UNKNOWN, r[0]) : fmi2OK;                                          \
    }                                                                                             \
    EXPORT(fmi2Status, fmi2Set##type)                                                             \
    (fmi2Component c, const fmi2ValueReference r[], size_t n, const ctype values[]) {             \
        UNUSED(values);                                                                           \
        return n ? as_status(c, UNKNOWN, r[0]) : fmi2OK;                                          \
    }
NONE_OF(Integer, fmi2Integer)
NONE_OF(Boolean, fmi2Boolean)
NONE_OF(String, fmi2String)

EXPORT(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (!*state) *state = malloc(sizeof(Solid));
    if (!*state) return report(c, fmi2Error, "no memory for the state");
    memcpy(*state, &((Instance *)c)->solid, sizeof(Solid));
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    memcpy(&((Instance *)c)->solid, state, sizeof(Solid));
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    UNUSED(c);
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    UNUSED(c), UNUSED(state);
    *size = sizeof(Solid);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SerializeFMUstate)
(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (size < sizeof(Solid)) return report(c, fmi2Error, "too small for the state");
    memcpy(bytes, state, sizeof(Solid));
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2DeSerializeFMUstate)
(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    if (size != sizeof(Solid) || memcmp(bytes + offsetof(Solid, token), TOKEN, sizeof TOKEN))
        return report(c, fmi2Error, "this is not a state of this FMU");
    if (!*state) *state = malloc(sizeof(Solid));
    if (!*state) return report(c, fmi2Error, "no memory for the state");
    memcpy(*state, bytes, size);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetDirectionalDerivative)
(fmi2Component c, const fmi2ValueReference unknown[], size_t nu, const fmi2ValueReference known[],
 size_t nk, const fmi2Real seed[], fmi2Real sensitivity[]) {
    UNUSED(unknown), UNUSED(nu), UNUSED(known), UNUSED(nk), UNUSED(seed), UNUSED(sensitivity);
    return report(c, fmi2Error, "this FMU provides no directional derivatives");
}

/* Model Exchange */

EXPORT(fmi2Status, fmi2EnterEventMode)(fmi2Component c) { UNUSED(c); return fmi2OK; }
EXPORT(fmi2Status, fmi2EnterContinuousTimeMode)(fmi2Component c) { UNUSED(c); return fmi2OK; }

EXPORT(fmi2Status, fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info) {
    UNUSED(c);
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2CompletedIntegratorStep)
(fmi2Component c, fmi2Boolean keep, fmi2Boolean *event, fmi2Boolean *terminate) {
    UNUSED(c), UNUSED(keep);
    *event = *terminate = 0;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetTime)(fmi2Component c, fmi2Real time) {
    ((Instance *)c)->solid.time = time;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t n) {
    if (n != STATES) return report(c, fmi2Error, "wrong number of states");
    memcpy(((Instance *)c)->solid.state, x, n * sizeof *x);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t n) {
    if (n != STATES) return report(c, fmi2Error, "wrong number of states");
    memcpy(x, ((Instance *)c)->solid.state, n * sizeof *x);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t n) {
    double all[STATES + 1];
    if (n != STATES) return report(c, fmi2Error, "wrong number of states");
    find_derivatives(&((Instance *)c)->solid, all);
    memcpy(derivatives, all, n * sizeof *all);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t n) {
    UNUSED(indicators);
    return n ? report(c, fmi2Error, "this FMU has no event indicators") : fmi2OK;
}

EXPORT(fmi2Status, fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real x[], size_t n) {
    UNUSED(c);
    for (size_t at = 0; at < n; at++) x[at] = 1;
    return fmi2OK;
}

/* Co-Simulation */

EXPORT(fmi2Status, fmi2SetRealInputDerivatives)
(fmi2Component c, const fmi2ValueReference references[], size_t n, const fmi2Integer order[],
 const fmi2Real values[]) {
    Instance *i = c;
    for (size_t at = 0; at < n; at++) {
        if (order[at] != 1 || !isfinite(values[at]))
            return report(i, fmi2Error, "expected finite first derivatives of inputs");
        if (references[at] == INPUT) i->solid.derivative = values[at];
        else if (references[at] != RATE) return as_status(i, UNKNOWN, references[at]);
    }
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetRealOutputDerivatives)
(fmi2Component c, const fmi2ValueReference references[], size_t n, const fmi2Integer order[],
 fmi2Real values[]) {
    UNUSED(references), UNUSED(order), UNUSED(values);
    return n ? report(c, fmi2Error, "this FMU has no output derivatives") : fmi2OK;
}

EXPORT(fmi2Status, fmi2DoStep)
(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean keep) {
    Instance *i = c;
    UNUSED(keep);
    if (i->solid.stage != RUNNING || advance(&i->solid, time, step))
        return report(i, fmi2Error, "the step is negative, not finite or not in its place");
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2CancelStep)(fmi2Component c) {
    return report(c, fmi2Error, "there is no step to cancel");
}

/* No step is pending, so there is nothing to ask for. */
#define NO_STATUS(type, ctype)                                                                    \
    EXPORT(fmi2Status, fmi2Get##type)(fmi2Component c, const fmi2StatusKind kind, ctype * value) { \
        UNUSED(c), UNUSED(kind), UNUSED(value);                                                   \
        return fmi2Discard;                                                                       \
    }
NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(BooleanStatus, fmi2Boolean)
NO_STATUS(StringStatus, fmi2String)

EXPORT(fmi2Status, fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != 2) return fmi2Discard;
    *value = ((Instance *)c)->solid.time;
    return fmi2OK;
}
