/* reliab_monitor as an FMU for co-simulation, FMI 2.0. The importer brings fmi2Functions.h. */
#include "fmi2Functions.h"

#include "unit.h"

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    return type == fmi2CoSimulation ? unit_made(guid) : NULL;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    unit_rest((unit *)c);
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Real values[])
{
    size_t i;
    int refused = 0;
    for (i = 0u; i < n; i++) {
        refused |= unit_set((unit *)c, at[i], values[i]);
    }
    return refused ? fmi2Error : fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Real values[])
{
    size_t i;
    int refused = 0;
    for (i = 0u; i < n; i++) {
        refused |= unit_get((const unit *)c, at[i], &values[i]);
    }
    return refused ? fmi2Error : fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Integer values[])
{
    size_t i;
    int refused = 0;
    for (i = 0u; i < n; i++) {
        refused |= unit_get_whole((const unit *)c, at[i], &values[i]);
    }
    return refused ? fmi2Error : fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Boolean values[])
{
    size_t i;
    int refused = 0;
    for (i = 0u; i < n; i++) {
        refused |= unit_set_yes_or_no((unit *)c, at[i], values[i] != fmi2False);
    }
    return refused ? fmi2Error : fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Boolean values[])
{
    size_t i;
    int refused = 0;
    for (i = 0u; i < n; i++) {
        int value;
        refused |= unit_get_yes_or_no((const unit *)c, at[i], &value);
        values[i] = value != 0 ? fmi2True : fmi2False;
    }
    return refused ? fmi2Error : fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean final)
{
    static const fmi2Status answers[3] = {fmi2OK, fmi2Warning, fmi2Error};
    (void)now, (void)final;
    return answers[unit_step((unit *)c, step)];
}

/* There is nothing else to set, get or store. */
#define REFUSED(name, ...) fmi2Status name(__VA_ARGS__)
REFUSED(fmi2GetString, fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2String v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2SetInteger, fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Integer v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2SetString, fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2String v[])
{ (void)c, (void)at, (void)v; return n == 0u ? fmi2OK : fmi2Error; }
REFUSED(fmi2GetFMUstate, fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2SetFMUstate, fmi2Component c, fmi2FMUstate s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2FreeFMUstate, fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
REFUSED(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n) { (void)c, (void)s, (void)n; return fmi2Error; }
REFUSED(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
{ (void)c, (void)s, (void)b, (void)n; return fmi2Error; }
REFUSED(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
{ (void)c, (void)b, (void)n, (void)s; return fmi2Error; }
REFUSED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
{ (void)c, (void)u, (void)nu, (void)k, (void)nk, (void)dk, (void)du; return fmi2Error; }
REFUSED(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference at[], size_t n,
        const fmi2Integer order[], const fmi2Real v[])
{ (void)c, (void)at, (void)n, (void)order, (void)v; return fmi2Error; }
REFUSED(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference at[], size_t n,
        const fmi2Integer order[], fmi2Real v[])
{ (void)c, (void)at, (void)n, (void)order, (void)v; return fmi2Error; }
REFUSED(fmi2CancelStep, fmi2Component c) { (void)c; return fmi2Error; }
REFUSED(fmi2GetStatus, fmi2Component c, const fmi2StatusKind k, fmi2Status *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind k, fmi2Real *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetBooleanStatus, fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
REFUSED(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind k, fmi2String *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
