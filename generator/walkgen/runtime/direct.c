/* direct.c: a generated function called on one row, without the ways of NumPy's ufuncs around it; runtime/direct.py compiles it.
 *
 *     Direct(function, large, inputs, outputs, loops, defaults, required, positional)
 *
 *     function    what every other call is left to, and what answers for names and texts
 *     large       what calls are left to whose first input is a large array
 *     inputs      a tuple of ports: (kind "real", "integer" or "truth", sizes...)
 *     outputs     likewise
 *     loops       addresses of the function's loop over NumPy's rows in double and in float; 0 where there is none
 *     defaults    for double and for float a tuple of arrays, None where an input has to be given
 *     required    how many inputs have to be given
 *     positional  how many may be, by position
 *
 * A call is its own affair where every input is an array of exactly the port's shape and of the loop's type, in any strides, or numbers
 * of Python that NumPy would take for it: the same loop then runs on the same numbers. Like NumPy's ufuncs with little to do it keeps the
 * interpreter's lock.
 */
#define PY_SSIZE_T_CLEAN
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <Python.h>
#include <numpy/arrayobject.h>
#include <numpy/arrayscalars.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define MOST_PORTS 32
#define HIGHEST_RANK 6
#define MOST_NUMBERS 64 /* from lists, in one call */
#define LARGE_INPUT 1048576 /* bytes */

typedef void (*loop_function)(char **arguments, const npy_intp *dimensions, const npy_intp *steps, void *data);

enum { REAL, INTEGER, TRUTH };

static PyArray_Descr *descriptions[3]; /* of what comes out: double, float, int32 */

typedef struct {
    int kind, rank;
    npy_intp sizes[HIGHEST_RANK];
} port;

typedef struct {
    PyObject_HEAD
    vectorcallfunc vectorcall;
    PyObject *function, *large, *defaults[2];
    loop_function loops[2];
    int inputs, outputs, required, positional;
    port ports[MOST_PORTS];
} direct;

/* What one call passes to the loop: pointers, then steps from row to row, then those of every core dimension. */
typedef struct {
    char *data[MOST_PORTS];
    npy_intp steps[MOST_PORTS * (1 + HIGHEST_RANK)];
    npy_intp *core;
    int single; /* float: -1 while nothing has told */
    int used;
    union {
        double real;
        int64_t integer;
    } numbers[MOST_NUMBERS];
} call;

/* Whether an array with numbers of this precision fits what came before. */
static int agrees(call *made, const direct *self, int type) {
    const int single = type == NPY_FLOAT;
    if ((!single && type != NPY_DOUBLE) || (made->single >= 0 && made->single != single) || self->loops[single] == NULL) {
        return 0;
    }
    made->single = single;
    return 1;
}

static int takes_array(call *made, const direct *self, const port *wanted, PyArrayObject *array, int place) {
    const int type = PyArray_DESCR(array)->type_num;
    if (PyArray_NDIM(array) != wanted->rank || !PyArray_ISNOTSWAPPED(array)) {
        return 0;
    }
    if (wanted->kind == REAL ? !agrees(made, self, type) : type != NPY_INT64) {
        return 0;
    }
    for (int axis = 0; axis < wanted->rank; ++axis) {
        if (PyArray_DIM(array, axis) != wanted->sizes[axis]) {
            return 0;
        }
        *made->core++ = PyArray_STRIDE(array, axis);
    }
    made->data[place] = PyArray_BYTES(array);
    return 1;
}

/* One number of Python's, or NumPy's double. Whole numbers beyond int64 are NumPy's affair. */
static int takes_number(call *made, int kind, PyObject *value) {
    if (made->used == MOST_NUMBERS) {
        return 0;
    }
    if (kind == REAL && (PyFloat_CheckExact(value) || Py_IS_TYPE(value, &PyDoubleArrType_Type))) {
        made->numbers[made->used++].real = PyFloat_AS_DOUBLE(value);
        return 1;
    }
    if (!PyLong_CheckExact(value)) {
        return 0;
    }
    int overflow = 0;
    const long long whole = PyLong_AsLongLongAndOverflow(value, &overflow);
    if (overflow) {
        return 0;
    }
    if (kind == REAL) {
        made->numbers[made->used++].real = (double)whole;
    } else {
        made->numbers[made->used++].integer = whole;
    }
    return 1;
}

/* A list or a tuple, which are double, or a number, which where there is a float loop suits both: then NumPy decides. */
static int takes_numbers(call *made, const direct *self, const port *wanted, PyObject *value, int place) {
    made->data[place] = (char *)&made->numbers[made->used];
    if (wanted->rank == 0) {
        return self->loops[1] == NULL && takes_number(made, wanted->kind, value);
    }
    if (wanted->rank != 1 || wanted->kind != REAL || !(PyList_CheckExact(value) || PyTuple_CheckExact(value)) ||
        PySequence_Fast_GET_SIZE(value) != wanted->sizes[0] || !agrees(made, self, NPY_DOUBLE)) {
        return 0;
    }
    *made->core++ = (npy_intp)sizeof(double);
    for (npy_intp at = 0; at < wanted->sizes[0]; ++at) {
        if (!takes_number(made, REAL, PySequence_Fast_GET_ITEM(value, at))) {
            return 0;
        }
    }
    return 1;
}

/* All inputs, those left out by default; 0 where the call is not of this sort. */
static int takes_all(call *made, const direct *self, PyObject *const *arguments, int given) {
    for (int place = 0; place < given; ++place) {
        PyObject *value = arguments[place];
        const port *wanted = &self->ports[place];
        if (!(PyArray_CheckExact(value) ? takes_array(made, self, wanted, (PyArrayObject *)value, place)
                                        : takes_numbers(made, self, wanted, value, place))) {
            return 0;
        }
    }
    if (made->single < 0 && self->loops[1] != NULL) {
        return 0;
    }
    for (int place = given; place < self->inputs; ++place) {
        PyObject *value = PyTuple_GET_ITEM(self->defaults[made->single > 0], place);
        if (!takes_array(made, self, &self->ports[place], (PyArrayObject *)value, place)) {
            return 0;
        }
    }
    return 1;
}

typedef union {
    double real;
    float single;
    npy_int32 integer;
} scalar;

static PyObject *scalar_of(const port *wanted, int single, scalar value) {
    PyObject *made;
    if (wanted->kind == TRUTH) {
        PyArrayScalar_RETURN_BOOL_FROM_LONG(value.integer != 0);
    }
    if (wanted->kind == INTEGER) {
        if ((made = PyArrayScalar_New(Int)) != NULL) {
            PyArrayScalar_ASSIGN(made, Int, value.integer);
        }
    } else if (single) {
        if ((made = PyArrayScalar_New(Float)) != NULL) {
            PyArrayScalar_ASSIGN(made, Float, value.single);
        }
    } else if ((made = PyArrayScalar_New(Double)) != NULL) {
        PyArrayScalar_ASSIGN(made, Double, value.real);
    }
    return made;
}

/* Places for the outputs, those of scalars in `scalars`; how many were made. */
static int makes_outputs(call *made, const direct *self, PyObject **results, scalar *scalars) {
    for (int place = 0; place < self->outputs; ++place) {
        port *wanted = (port *)&self->ports[self->inputs + place];
        if (wanted->rank == 0) {
            made->data[self->inputs + place] = (char *)&scalars[place];
            results[place] = NULL;
            continue;
        }
        PyArray_Descr *type = descriptions[wanted->kind != REAL ? 2 : made->single > 0];
        Py_INCREF(type);
        results[place] = PyArray_NewFromDescr(&PyArray_Type, type, wanted->rank, wanted->sizes, NULL, NULL, 0, NULL);
        if (results[place] == NULL) {
            return place;
        }
        PyArrayObject *array = (PyArrayObject *)results[place];
        made->data[self->inputs + place] = PyArray_BYTES(array);
        memcpy(made->core, PyArray_STRIDES(array), sizeof(npy_intp) * (size_t)wanted->rank);
        made->core += wanted->rank;
    }
    return self->outputs;
}

/* The one result, or the tuple of all; what was made is given up where one is missing. */
static PyObject *gathered(PyObject **results, int count, int missing) {
    PyObject *all = missing ? NULL : count == 1 ? results[0] : PyTuple_New(count);
    for (int place = 0; place < count; ++place) {
        if (all == NULL) {
            Py_XDECREF(results[place]);
        } else if (count > 1) {
            PyTuple_SET_ITEM(all, place, results[place]);
        }
    }
    return all;
}

static PyObject *run(const direct *self, call *made) {
    PyObject *results[MOST_PORTS];
    scalar scalars[MOST_PORTS];
    const npy_intp rows = 1;
    const int count = makes_outputs(made, self, results, scalars);
    int missing = count < self->outputs;
    if (!missing) {
        self->loops[made->single > 0](made->data, &rows, made->steps, NULL);
    }
    for (int place = 0; place < count; ++place) {
        const port *wanted = &self->ports[self->inputs + place];
        if (wanted->rank == 0) {
            results[place] = missing ? NULL : scalar_of(wanted, made->single > 0, scalars[place]);
            missing |= results[place] == NULL;
        }
    }
    return gathered(results, count, missing);
}

static PyObject *direct_call(PyObject *object, PyObject *const *arguments, size_t flagged, PyObject *names) {
    const direct *self = (const direct *)object;
    const Py_ssize_t given = PyVectorcall_NARGS(flagged);
    if ((names == NULL || PyTuple_GET_SIZE(names) == 0) && given >= self->required && given <= self->positional) {
        call made;
        made.single = -1;
        made.used = 0;
        memset(made.steps, 0, sizeof(npy_intp) * (size_t)(self->inputs + self->outputs));
        made.core = made.steps + self->inputs + self->outputs;
        if (takes_all(&made, self, arguments, (int)given)) {
            return run(self, &made);
        }
        if (given > 0 && PyArray_Check(arguments[0]) && PyArray_NBYTES((PyArrayObject *)arguments[0]) >= LARGE_INPUT) {
            return PyObject_Vectorcall(self->large, arguments, flagged, names);
        }
    }
    return PyObject_Vectorcall(self->function, arguments, flagged, names);
}

static int read_port(PyObject *text, port *read) {
    static const char *const kinds[] = {"real", "integer", "truth"};
    const Py_ssize_t rank = PyTuple_Check(text) ? PyTuple_GET_SIZE(text) - 1 : -1;
    const char *kind = rank < 0 || rank > HIGHEST_RANK ? NULL : PyUnicode_AsUTF8(PyTuple_GET_ITEM(text, 0));
    if (kind == NULL) {
        return PyErr_Occurred() ? 0 : (PyErr_SetString(PyExc_ValueError, "a port is a tuple: its kind, its sizes"), 0);
    }
    read->kind = REAL;
    while (read->kind < TRUTH && strcmp(kind, kinds[read->kind]) != 0) {
        ++read->kind;
    }
    read->rank = (int)rank;
    for (Py_ssize_t axis = 0; axis < rank; ++axis) {
        read->sizes[axis] = PyLong_AsSsize_t(PyTuple_GET_ITEM(text, axis + 1));
    }
    return PyErr_Occurred() == NULL;
}

static int read_ports(direct *self, PyObject *inputs, PyObject *outputs) {
    self->inputs = (int)PyTuple_GET_SIZE(inputs);
    self->outputs = (int)PyTuple_GET_SIZE(outputs);
    if (self->inputs + self->outputs > MOST_PORTS || self->outputs == 0) {
        PyErr_SetString(PyExc_ValueError, "too many ports, or no output");
        return 0;
    }
    for (int place = 0; place < self->inputs + self->outputs; ++place) {
        PyObject *text = place < self->inputs ? PyTuple_GET_ITEM(inputs, place) : PyTuple_GET_ITEM(outputs, place - self->inputs);
        if (!read_port(text, &self->ports[place])) {
            return 0;
        }
    }
    return 1;
}

/* Every input that may be left out has an array, for each loop that there is. */
static int has_defaults(const direct *self) {
    for (int precision = 0; precision < 2; ++precision) {
        const int asked = self->loops[precision] != NULL;
        if (asked && PyTuple_GET_SIZE(self->defaults[precision]) != self->inputs) {
            return 0;
        }
        for (int place = self->required; asked && place < self->inputs; ++place) {
            if (!PyArray_CheckExact(PyTuple_GET_ITEM(self->defaults[precision], place))) {
                return 0;
            }
        }
    }
    return self->loops[0] != NULL && self->required >= 0 && self->positional <= self->inputs;
}

static PyObject *direct_new(PyTypeObject *type, PyObject *arguments, PyObject *named) {
    PyObject *function, *large, *inputs, *outputs, *defaults[2];
    unsigned long long loops[2];
    int required, positional;
    direct *self;
    if (named != NULL || !PyArg_ParseTuple(arguments, "OOO!O!(KK)(O!O!)ii", &function, &large, &PyTuple_Type, &inputs, &PyTuple_Type, &outputs,
                                           &loops[0], &loops[1], &PyTuple_Type, &defaults[0], &PyTuple_Type, &defaults[1], &required,
                                           &positional)) {
        return NULL;
    }
    if ((self = (direct *)type->tp_alloc(type, 0)) == NULL) {
        return NULL;
    }
    self->vectorcall = direct_call;
    self->function = Py_NewRef(function);
    self->large = Py_NewRef(large);
    self->required = required;
    self->positional = positional;
    for (int precision = 0; precision < 2; ++precision) {
        self->defaults[precision] = Py_NewRef(defaults[precision]);
        self->loops[precision] = (loop_function)(uintptr_t)loops[precision];
    }
    if (read_ports(self, inputs, outputs) && has_defaults(self)) {
        return (PyObject *)self;
    }
    if (!PyErr_Occurred()) {
        PyErr_SetString(PyExc_ValueError, "no loop in double, or an input that may be left out without its default");
    }
    Py_DECREF(self);
    return NULL;
}

static void direct_delete(PyObject *object) {
    direct *self = (direct *)object;
    Py_CLEAR(self->function);
    Py_CLEAR(self->large);
    Py_CLEAR(self->defaults[0]);
    Py_CLEAR(self->defaults[1]);
    Py_TYPE(object)->tp_free(object);
}

static PyObject *direct_text(PyObject *object) { return PyObject_Repr(((direct *)object)->function); }

/* Names, texts and all that the function has beside. */
static PyObject *direct_attribute(PyObject *object, PyObject *name) {
    PyObject *found = PyObject_GetAttr(((direct *)object)->function, name);
    if (found == NULL && PyErr_ExceptionMatches(PyExc_AttributeError)) {
        PyErr_Clear();
        found = PyObject_GenericGetAttr(object, name);
    }
    return found;
}

static PyTypeObject direct_type = {
    PyVarObject_HEAD_INIT(NULL, 0).tp_name = "walkgen.runtime.Direct",
    .tp_basicsize = sizeof(direct),
    .tp_vectorcall_offset = offsetof(direct, vectorcall),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL,
    .tp_call = PyVectorcall_Call,
    .tp_new = direct_new,
    .tp_dealloc = direct_delete,
    .tp_repr = direct_text,
    .tp_getattro = direct_attribute,
};

static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, .m_name = "walkgen_direct", .m_size = -1};

PyMODINIT_FUNC PyInit_walkgen_direct(void);
PyMODINIT_FUNC PyInit_walkgen_direct(void) {
    PyObject *made;
    import_array();
    descriptions[0] = PyArray_DescrFromType(NPY_DOUBLE);
    descriptions[1] = PyArray_DescrFromType(NPY_FLOAT);
    descriptions[2] = PyArray_DescrFromType(NPY_INT32);
    if (PyType_Ready(&direct_type) < 0 || (made = PyModule_Create(&module)) == NULL) {
        return NULL;
    }
    if (PyModule_AddObjectRef(made, "Direct", (PyObject *)&direct_type) < 0) {
        Py_DECREF(made);
        return NULL;
    }
    return made;
}
