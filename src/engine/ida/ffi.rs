//! The border to C: every call into SUNDIALS, and every call back.
//!
//! * Each C object has one Rust owner with a `Drop` of one line.
//! * Callbacks get one pointer, to a leaked [`Shared`] that [`Solver`] frees after IDA.
//! * Nothing unwinds into C: a callback catches the panic or the fault, keeps it and returns a
//!   flag; the call that started the solve resumes the panic or returns the fault whole.
//! * While IDA runs, the only reference to [`Shared`] is that of the running callback; IDA calls
//!   back one at a time.

use super::Error;
use super::inverse;
use super::matrix::{Dense, Sparse};
use super::shared::{Calls, Shared};
use super::tolerance::{Norm, Weights};
use super::vector_operations as operations;
use crate::dae::{Dae, Fault};
use std::ffi::{CStr, c_char, c_int, c_long, c_void};
use std::ptr;
use std::slice;
use sundials_sys::*;

mod left_out {
    #![allow(non_upper_case_globals, non_camel_case_types, non_snake_case, unused_imports)]
    include!(concat!(env!("OUT_DIR"), "/sundials.rs"));
}

const _: () = assert!(
    SUNDIALS_VERSION_MAJOR == 6 && SUNDIALS_VERSION_MINOR == 4,
    "freeplay needs the headers of SUNDIALS 6.4 (Debian and Ubuntu: apt install libsundials-dev); \
     sundials-sys found another version, or none and built its own"
);

/// Version of SUNDIALS that the program runs with: major, minor, patch.
pub(super) fn version() -> [i32; 3] {
    let [mut major, mut minor, mut patch] = [0; 3];
    let mut label: [c_char; 16] = [0; 16];
    // SAFETY: the pointers are to three integers and to a buffer of the length given.
    unsafe {
        left_out::SUNDIALSGetVersionNumber(
            &mut major,
            &mut minor,
            &mut patch,
            label.as_mut_ptr(),
            label.len() as c_int,
        );
    }
    [major, minor, patch]
}

struct Context(SUNContext);

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: made by `SUNContext_Create`, freed once, after all that was made with it.
        unsafe { SUNContext_Free(&mut self.0) };
    }
}

struct Vector(N_Vector);

impl Drop for Vector {
    fn drop(&mut self) {
        // SAFETY: made by `N_VNew_Serial`, freed once.
        unsafe { N_VDestroy(self.0) }
    }
}

struct Matrix(SUNMatrix);

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: made by `new_matrix`, freed once, after the solvers that use it.
        unsafe { SUNMatDestroy(self.0) }
    }
}

struct LinearSolver(SUNLinearSolver);

impl Drop for LinearSolver {
    fn drop(&mut self) {
        // SAFETY: made by `SUNLinSol_Dense` or `own_linear_solver`, freed once, after IDA.
        unsafe { SUNLinSolFree(self.0) };
    }
}

struct Memory(*mut c_void);

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: made by `IDACreate`, freed once, before all that it uses.
        unsafe { IDAFree(&mut self.0) }
    }
}

struct SharedBox<Y>(*mut Shared<Y>);

impl<Y> Drop for SharedBox<Y> {
    fn drop(&mut self) {
        // SAFETY: leaked from a `Box` by `Solver::new`, freed once, after IDA.
        drop(unsafe { Box::from_raw(self.0) });
    }
}

/// What IDA counted since it was last initialized.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counters {
    pub(super) steps: u64,
    pub(super) nonlinear_iterations: u64,
    pub(super) nonlinear_convergence_failures: u64,
    pub(super) error_test_failures: u64,
}

/// How a step of IDA ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Return {
    /// At a time of IDA's choice.
    Stepped,
    /// At the stop time, which IDA has forgotten.
    AtStopTime,
}

/// IDA with its vectors, matrix and linear solver, and the system that it solves.
///
/// The fields stand in the order in which they must be freed.
pub(super) struct Solver<Y: Dae> {
    memory: Memory,
    linear_solver: LinearSolver,
    matrix: Matrix,
    y: Vector,
    yp: Vector,
    between: Vector,
    shared: SharedBox<Y>,
    _context: Context,
}

impl<Y: Dae> Solver<Y> {
    /// Makes IDA ready for a system; the longest step is in s.
    pub(super) fn new(
        system: Y,
        weights: Weights,
        max_step: f64,
        stock_vector_operations: bool,
    ) -> Result<Self, Error> {
        let differential = 2 * system.coordinates() + system.inner_states();
        let (unknowns, norm) = (differential + system.multipliers(), weights.norm());
        let context = new_context()?;
        let y = new_vector(unknowns, &context)?;
        override_operations(&y, norm, stock_vector_operations);
        let yp = clone_vector(&y)?;
        let between = clone_vector(&y)?;
        let sparse = unknowns > DENSE_UNKNOWNS && !stock_vector_operations;
        let matrix = new_matrix(&context, unknowns, sparse)?;
        // SAFETY: the context is alive.
        let memory = Memory(made(unsafe { IDACreate(context.0) }, "an integrator")?);
        let linear_solver = if stock_vector_operations {
            // SAFETY: vector, matrix and context are alive and of one size.
            let linear_solver = unsafe { SUNLinSol_Dense(y.0, matrix.0, context.0) };
            LinearSolver(made(linear_solver, "a linear solver")?)
        } else {
            let method = match sparse {
                true => Method::Factors { klu: new_klu(&context, &y, &matrix)?, analysed: 0 },
                false => {
                    let (exchanges, pivot_column) = (vec![0; unknowns], vec![0.0; unknowns]);
                    Method::Inverse { exchanges, pivot_column }
                }
            };
            own_linear_solver(&context, &memory, differential, method)?
        };
        let mut shared = Shared::new(system, weights);
        if sparse {
            shared.sparse = Sparse::new(unknowns);
        }
        let shared = SharedBox(Box::into_raw(Box::new(shared)));
        let mut solver =
            Solver { memory, linear_solver, matrix, y, yp, between, shared, _context: context };
        solver.set_up(max_step, stock_vector_operations, sparse)?;
        Ok(solver)
    }

    /// The calls that IDA wants once.
    fn set_up(&mut self, max_step: f64, stock: bool, sparse: bool) -> Result<(), Error> {
        let (ida, shared) = (self.memory.0, self.shared.0);
        let jacobian = if sparse { sparse_jacobian::<Y> } else { jacobian::<Y> };
        let longest = if max_step.is_finite() { max_step } else { 0.0 };
        // SAFETY: IDA, vectors, matrix and linear solver are alive as long as `self`; `shared` is
        // the `Shared<Y>` that the callbacks of the same `Y` expect. The order is IDA's.
        let flags = unsafe {
            [
                IDASetErrHandlerFn(ida, Some(handle_error::<Y>), shared.cast()),
                IDAInit(ida, Some(residual::<Y>), 0.0, self.y.0, self.yp.0),
                IDASetUserData(ida, shared.cast()),
                IDAWFtolerances(ida, Some(weigh::<Y>)),
                IDASetLinearSolver(ida, self.linear_solver.0, self.matrix.0),
                IDASetLinearSolutionScaling(ida, c_int::from(stock)),
                IDASetJacFn(ida, Some(jacobian)),
                IDASetMaxOrd(ida, 5),
                IDASetMaxStep(ida, longest),
                IDASetMaxNumSteps(ida, -1),
                IDASetMaxErrTestFails(ida, 50),
            ]
        };
        flags.into_iter().try_for_each(|flag| self.check(flag, 0.0))
    }

    fn shared(&self) -> &Shared<Y> {
        // SAFETY: alive as long as `self`; no callback runs while `self` is borrowed outside of a
        // call into IDA, and those calls hold no reference to it.
        unsafe { &*self.shared.0 }
    }

    fn shared_mut(&mut self) -> &mut Shared<Y> {
        // SAFETY: as in `shared`, and `self` is borrowed exclusively.
        unsafe { &mut *self.shared.0 }
    }

    /// The system.
    pub(super) fn system(&mut self) -> &mut Y {
        &mut self.shared_mut().system
    }

    /// The system, to read.
    pub(super) fn system_ref(&self) -> &Y {
        &self.shared().system
    }

    /// Takes the last complaint that a shorter step might have mended.
    pub(super) fn take_setback(&mut self) -> Option<Fault> {
        self.shared_mut().setback.take()
    }

    /// How many steps asked for less error than rounding makes.
    pub(super) fn floored(&self) -> u64 {
        self.shared().weights.floored()
    }

    /// How often IDA called back since it was made.
    pub(super) fn calls(&self) -> Calls {
        self.shared().calls
    }

    /// y and ẏ: what IDA begins from, or where it stands.
    pub(super) fn unknowns_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        // SAFETY: two vectors of ours, that nothing else refers to while `self` is borrowed.
        unsafe { (components_mut(self.y.0), components_mut(self.yp.0)) }
    }

    /// y where IDA stands.
    pub(super) fn unknowns(&self) -> &[f64] {
        // SAFETY: a vector of ours, that nothing changes while `self` is borrowed.
        unsafe { components(self.y.0) }
    }

    /// Begins anew at a time (s) from [`Solver::unknowns_mut`], with a first step (s).
    pub(super) fn reinitialize(&mut self, time: f64, first_step: f64) -> Result<(), Error> {
        let ida = self.memory.0;
        self.shared_mut().weights.forget_rounding();
        // SAFETY: IDA copies the vectors, which are of the size that it was made for.
        let flags =
            unsafe { [IDAReInit(ida, time, self.y.0, self.yp.0), IDASetInitStep(ida, first_step)] };
        flags.into_iter().try_for_each(|flag| self.check(flag, time))
    }

    /// Sets the time (s) that no step goes beyond, until it is reached.
    pub(super) fn set_stop_time(&mut self, stop: f64) -> Result<(), Error> {
        // SAFETY: IDA is alive.
        let flag = unsafe { IDASetStopTime(self.memory.0, stop) };
        self.check(flag, stop)
    }

    /// One step towards `end` (s); returns the time (s) where it ended.
    pub(super) fn step(&mut self, end: f64) -> Result<(f64, Return), Error> {
        let mut time = f64::NAN;
        // SAFETY: IDA and vectors are alive; no reference to vectors or `Shared` is held here, so
        // the callbacks are free to make theirs.
        let flag =
            unsafe { IDASolve(self.memory.0, end, &mut time, self.y.0, self.yp.0, IDA_ONE_STEP) };
        self.check(flag, time)?;
        let ended = match flag {
            IDA_TSTOP_RETURN => Return::AtStopTime,
            _ => Return::Stepped,
        };
        Ok((time, ended))
    }

    /// y at a time (s) within the last step.
    pub(super) fn interpolate(&mut self, time: f64) -> Result<&[f64], Error> {
        // SAFETY: IDA and the vector are alive.
        let flag = unsafe { IDAGetDky(self.memory.0, time, 0, self.between.0) };
        self.check(flag, time)?;
        // SAFETY: a vector of ours, that nothing changes while `self` is borrowed.
        Ok(unsafe { components(self.between.0) })
    }

    /// What IDA counted since it was last initialized.
    pub(super) fn counters(&self) -> Counters {
        let ida = self.memory.0;
        let count = |get: unsafe extern "C" fn(*mut c_void, *mut c_long) -> c_int| {
            let mut value = 0;
            // SAFETY: IDA is alive and writes one integer; without success it stays 0.
            unsafe { get(ida, &mut value) };
            u64::try_from(value).unwrap_or(0)
        };
        Counters {
            steps: count(IDAGetNumSteps),
            nonlinear_iterations: count(IDAGetNumNonlinSolvIters),
            nonlinear_convergence_failures: count(IDAGetNumNonlinSolvConvFails),
            error_test_failures: count(IDAGetNumErrTestFails),
        }
    }

    /// Turns a flag of IDA, returned at a time (s), into what stopped it; resumes a caught panic.
    fn check(&mut self, flag: c_int, time: f64) -> Result<(), Error> {
        self.shared_mut().stopped()?;
        if flag >= 0 {
            return Ok(());
        }
        let shared = self.shared_mut();
        let words = std::mem::take(&mut shared.words);
        Err(Error::stopped(flag, time, words, shared.setback.take()))
    }
}

/// Systems of more unknowns are solved by sparse factors.
const DENSE_UNKNOWNS: usize = 48;

/// A pointer that SUNDIALS returned, if it could make what it points to.
fn made<T>(pointer: *mut T, what: &'static str) -> Result<*mut T, Error> {
    if pointer.is_null() { Err(Error::Memory(what)) } else { Ok(pointer) }
}

fn new_context() -> Result<Context, Error> {
    let mut context = ptr::null_mut();
    // SAFETY: without MPI the communicator is null; the context is written through the pointer.
    unsafe { SUNContext_Create(ptr::null_mut(), &mut context) };
    Ok(Context(made(context, "a context")?))
}

/// A square matrix: dense, or sparse with its entries column by column.
fn new_matrix(context: &Context, unknowns: usize, sparse: bool) -> Result<Matrix, Error> {
    let size = unknowns as sunindextype;
    // SAFETY: the context is alive.
    let matrix = unsafe {
        match sparse {
            true => SUNSparseMatrix(size, size, size, CSC_MAT as c_int, context.0),
            false => SUNDenseMatrix(size, size, context.0),
        }
    };
    Ok(Matrix(made(matrix, "a matrix")?))
}

/// SUNDIALS' solver by the sparse factors of KLU (Davis and Palamadai Natarajan 2010, ACM
/// Transactions on Mathematical Software 37, article 36).
fn new_klu(context: &Context, vector: &Vector, matrix: &Matrix) -> Result<LinearSolver, Error> {
    // SAFETY: vector, matrix and context are alive and of one size; the matrix is a sparse one.
    let klu = unsafe { left_out::SUNLinSol_KLU(vector.0, matrix.0, context.0) };
    Ok(LinearSolver(made(klu, "a linear solver")?))
}

fn new_vector(length: usize, context: &Context) -> Result<Vector, Error> {
    // SAFETY: the context is alive.
    let vector = unsafe { N_VNew_Serial(length as sunindextype, context.0) };
    let vector = Vector(made(vector, "a vector")?);
    // SAFETY: SUNDIALS leaves the components undefined; they are written before any is read.
    unsafe { (*(*vector.0).content.cast::<_N_VectorContent_Serial>()).data.write_bytes(0, length) };
    Ok(vector)
}

fn clone_vector(vector: &Vector) -> Result<Vector, Error> {
    // SAFETY: the vector is alive; its clone copies the table of operations.
    let clone = Vector(made(unsafe { N_VClone(vector.0) }, "a vector")?);
    // SAFETY: both are alive, distinct and of one length.
    unsafe { N_VConst(0.0, clone.0) };
    Ok(clone)
}

/// Puts our operations into a vector's table, from which IDA's clones copy it.
fn override_operations(vector: &Vector, norm: Norm, stock: bool) {
    // SAFETY: a vector owns its table; nothing else refers to it.
    let table = unsafe { &mut *(*vector.0).ops };
    if norm == Norm::Ode15s {
        table.nvwrmsnorm = Some(largest);
        table.nvwrmsnormmask = Some(largest_masked);
    }
    if stock {
        return;
    }
    if norm == Norm::Wrms {
        table.nvwrmsnorm = Some(root_mean_square);
    }
    table.nvlinearsum = Some(linear_sum);
    table.nvconst = Some(fill);
    table.nvscale = Some(scale);
    table.nvlinearcombination = Some(linear_combination);
    table.nvlinearsumvectorarray = Some(linear_sum_array);
    table.nvscalevectorarray = Some(scale_array);
}

/// The components of a serial vector.
///
/// # Safety
/// `vector` is a serial vector, and nothing writes to it during `'a`.
#[inline(always)]
unsafe fn components<'a>(vector: N_Vector) -> &'a [f64] {
    // SAFETY: the caller's contract; a serial vector's content has this layout.
    unsafe {
        let content = &*(*vector).content.cast::<_N_VectorContent_Serial>();
        slice::from_raw_parts(content.data, content.length as usize)
    }
}

/// The components of a serial vector, to write.
///
/// # Safety
/// `vector` is a serial vector, and nothing else reads or writes it during `'a`.
#[inline(always)]
unsafe fn components_mut<'a>(vector: N_Vector) -> &'a mut [f64] {
    // SAFETY: the caller's contract; a serial vector's content has this layout.
    unsafe {
        let content = &*(*vector).content.cast::<_N_VectorContent_Serial>();
        slice::from_raw_parts_mut(content.data, content.length as usize)
    }
}

// The operations below are called by IDA with serial vectors of one length. Two arguments may be
// the same vector, never two vectors that overlap in part.

unsafe extern "C" fn linear_sum(a: f64, x: N_Vector, b: f64, y: N_Vector, z: N_Vector) {
    // SAFETY: IDA's contract above; in each branch the mutable slice is of a vector that no other
    // slice is of.
    unsafe {
        if z == x && z == y {
            operations::scale_in_place(a + b, components_mut(z));
        } else if z == x {
            operations::linear_sum_in_place(a, components_mut(z), b, components(y));
        } else if z == y {
            operations::linear_sum_in_place(b, components_mut(z), a, components(x));
        } else {
            operations::linear_sum(a, components(x), b, components(y), components_mut(z));
        }
    }
}

unsafe extern "C" fn fill(c: f64, z: N_Vector) {
    // SAFETY: IDA's contract above.
    unsafe { components_mut(z) }.fill(c);
}

unsafe extern "C" fn scale(c: f64, x: N_Vector, z: N_Vector) {
    // SAFETY: IDA's contract above; x and z are the same vector or distinct.
    unsafe {
        if z == x {
            operations::scale_in_place(c, components_mut(z));
        } else {
            operations::scale(c, components(x), components_mut(z));
        }
    }
}

unsafe extern "C" fn linear_combination(
    number: c_int,
    factors: *mut f64,
    vectors: *mut N_Vector,
    z: N_Vector,
) -> c_int {
    /// # Safety
    /// `factors` and `vectors` point to `K` numbers and serial vectors, none of which is `z`.
    unsafe fn combine<const K: usize>(factors: *mut f64, vectors: *mut N_Vector, z: N_Vector) {
        // SAFETY: the caller's contract.
        unsafe {
            let factors = *factors.cast::<[f64; K]>();
            let vectors = *vectors.cast::<[N_Vector; K]>();
            let x = vectors.map(|x| components(x));
            operations::linear_combination(factors, x, components_mut(z));
        }
    }
    // SAFETY: both arrays have `number` members. IDA combines into a vector of its own; a
    // combination in place, or a longer one, is left to SUNDIALS.
    unsafe {
        let in_place = slice::from_raw_parts(vectors, number as usize).contains(&z);
        match number {
            1 if !in_place => combine::<1>(factors, vectors, z),
            2 if !in_place => combine::<2>(factors, vectors, z),
            3 if !in_place => combine::<3>(factors, vectors, z),
            4 if !in_place => combine::<4>(factors, vectors, z),
            5 if !in_place => combine::<5>(factors, vectors, z),
            6 if !in_place => combine::<6>(factors, vectors, z),
            _ => return N_VLinearCombination_Serial(number, factors, vectors, z),
        }
    }
    0
}

unsafe extern "C" fn linear_sum_array(
    number: c_int,
    a: f64,
    x: *mut N_Vector,
    b: f64,
    y: *mut N_Vector,
    z: *mut N_Vector,
) -> c_int {
    for i in 0..number as usize {
        // SAFETY: each array has `number` members.
        unsafe { linear_sum(a, *x.add(i), b, *y.add(i), *z.add(i)) };
    }
    0
}

unsafe extern "C" fn scale_array(
    number: c_int,
    factors: *mut f64,
    x: *mut N_Vector,
    z: *mut N_Vector,
) -> c_int {
    for i in 0..number as usize {
        // SAFETY: each array has `number` members.
        unsafe { scale(*factors.add(i), *x.add(i), *z.add(i)) };
    }
    0
}

unsafe extern "C" fn largest(x: N_Vector, w: N_Vector) -> f64 {
    // SAFETY: IDA's contract above; nothing is written.
    unsafe { operations::largest(components(x), components(w)) }
}

unsafe extern "C" fn largest_masked(x: N_Vector, w: N_Vector, mask: N_Vector) -> f64 {
    // SAFETY: IDA's contract above; nothing is written.
    let (x, w, mask) = unsafe { (components(x), components(w), components(mask)) };
    let counted = x.iter().zip(w).zip(mask).filter(|(_, mask)| **mask > 0.0);
    counted.fold(0.0, |norm, ((x, w), _)| norm.max(operations::largest(&[*x], &[*w])))
}

unsafe extern "C" fn root_mean_square(x: N_Vector, w: N_Vector) -> f64 {
    // SAFETY: IDA's contract above; nothing is written.
    unsafe { operations::root_mean_square(components(x), components(w)) }
}

/// What our linear solver knows.
struct LinearContent {
    /// The integrator that it solves for.
    ida: *mut c_void,
    /// c_j for which the matrix was set up (1/s).
    set_up_for: f64,
    /// Place of the first multiplier among the unknowns.
    multipliers_from: usize,
    method: Method,
}

/// How linear equations are solved.
enum Method {
    /// By the inverse of a dense matrix, with scratch space.
    Inverse { exchanges: Vec<usize>, pivot_column: Vec<f64> },
    /// By the factors of a sparse one; `analysed` counts the entries of the pattern they are for.
    Factors { klu: LinearSolver, analysed: usize },
}

/// A linear solver that scales its solutions itself.
fn own_linear_solver(
    context: &Context,
    memory: &Memory,
    multipliers_from: usize,
    method: Method,
) -> Result<LinearSolver, Error> {
    // SAFETY: the context is alive.
    let solver = made(unsafe { SUNLinSolNewEmpty(context.0) }, "a linear solver")?;
    let content = LinearContent { ida: memory.0, set_up_for: f64::NAN, multipliers_from, method };
    // SAFETY: a linear solver owns its table and content; nothing else refers to them yet.
    unsafe {
        (*solver).content = Box::into_raw(Box::new(content)).cast();
        let table = &mut *(*solver).ops;
        table.gettype = Some(is_direct);
        table.setup = Some(set_up);
        table.solve = Some(solve);
        table.free = Some(free_own);
    }
    Ok(LinearSolver(solver))
}

unsafe extern "C" fn is_direct(_solver: SUNLinearSolver) -> SUNLinearSolver_Type {
    SUNLinearSolver_Type_SUNLINEARSOLVER_DIRECT
}

unsafe extern "C" fn free_own(solver: SUNLinearSolver) -> c_int {
    // SAFETY: called once, by `SUNLinSolFree`, on a solver of `own_linear_solver`.
    unsafe {
        drop(Box::from_raw((*solver).content.cast::<LinearContent>()));
        (*solver).content = ptr::null_mut();
        SUNLinSolFreeEmpty(solver);
    }
    SUNLS_SUCCESS as c_int
}

/// Replaces the matrix by its inverse, or factors it.
unsafe extern "C" fn set_up(solver: SUNLinearSolver, matrix: SUNMatrix) -> c_int {
    // SAFETY: IDA calls with the matrix of `Solver::new`, and does not use it itself; the content is
    // that of `own_linear_solver`, its integrator is the one that calls, and its method is the one
    // that the kind of matrix was made for.
    unsafe {
        let content = &mut *(*solver).content.cast::<LinearContent>();
        IDAGetCurrentCj(content.ida, &mut content.set_up_for);
        match &mut content.method {
            Method::Inverse { exchanges, pivot_column } => {
                let n = exchanges.len();
                let numbers = slice::from_raw_parts_mut(SUNDenseMatrix_Data(matrix), n * n);
                let regular = inverse::invert(numbers, exchanges, pivot_column);
                if regular { SUNLS_SUCCESS as c_int } else { SUNLS_LUFACT_FAIL as c_int }
            }
            Method::Factors { klu, analysed } => {
                let columns = SUNSparseMatrix_Columns(matrix) as usize;
                let entries = *SUNSparseMatrix_IndexPointers(matrix).add(columns);
                if entries as usize != *analysed {
                    *analysed = entries as usize;
                    let partial = left_out::SUNKLU_REINIT_PARTIAL as c_int;
                    left_out::SUNLinSol_KLUReInit(klu.0, matrix, entries, partial);
                }
                SUNLinSolSetup(klu.0, matrix)
            }
        }
    }
}

/// Solves with the inverse or the factors.
///
/// Where c_j has changed since the matrix was set up, changes of q, v and z are scaled as IDA would
/// scale all: by 2/(1 + c_j/c_j⁽⁰⁾). The multipliers are not: theirs follow accelerations, whose
/// size does not depend on c_j. What IDA's scaling leaves of them no norm sees, and extrapolation
/// makes it thirty times larger in the next step: they grew to 1e15 until no step was left.
unsafe extern "C" fn solve(
    solver: SUNLinearSolver,
    matrix: SUNMatrix,
    x: N_Vector,
    b: N_Vector,
    tolerance: f64,
) -> c_int {
    // SAFETY: as in `set_up`, which was called before; the vectors are distinct and of its size.
    unsafe {
        let content = &*(*solver).content.cast::<LinearContent>();
        let solved = match &content.method {
            Method::Inverse { .. } => {
                let (x, b) = (components_mut(x), components(b));
                let numbers = slice::from_raw_parts(SUNDenseMatrix_Data(matrix), b.len() * b.len());
                inverse::multiply(numbers, b, x);
                SUNLS_SUCCESS as c_int
            }
            Method::Factors { klu, .. } => SUNLinSolSolve(klu.0, matrix, x, b, tolerance),
        };
        let mut cj = content.set_up_for;
        IDAGetCurrentCj(content.ida, &mut cj);
        let ratio = cj / content.set_up_for;
        if ratio != 1.0 {
            let changes = &mut components_mut(x)[..content.multipliers_from];
            operations::scale_in_place(2.0 / (1.0 + ratio), changes);
        }
        solved
    }
}

/// Runs `f` for a callback and returns the flag that IDA expects.
///
/// # Safety
/// `user` is the `Shared<Y>` set by `Solver::new`, and nothing else refers to it meanwhile.
#[inline(always)]
unsafe fn guard<Y: Dae>(
    user: *mut c_void,
    time: f64,
    f: impl FnOnce(&mut Shared<Y>) -> Result<(), Fault>,
) -> c_int {
    // SAFETY: the caller's contract.
    unsafe { &mut *user.cast::<Shared<Y>>() }.guard(time, f)
}

unsafe extern "C" fn residual<Y: Dae>(
    time: f64,
    y: N_Vector,
    yp: N_Vector,
    residual: N_Vector,
    user: *mut c_void,
) -> c_int {
    // SAFETY: IDA hands back `user` and three distinct vectors, and calls back one at a time.
    unsafe {
        let (y, yp, residual) = (components(y), components(yp), components_mut(residual));
        guard::<Y>(user, time, |shared| shared.residual(time, y, yp, residual))
    }
}

unsafe extern "C" fn jacobian<Y: Dae>(
    time: f64,
    cj: f64,
    y: N_Vector,
    yp: N_Vector,
    _residual: N_Vector,
    matrix: SUNMatrix,
    user: *mut c_void,
    _: N_Vector,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: as in `residual`; the matrix is the dense one of `Solver::new`, column by column,
    // zeroed by IDA.
    unsafe {
        let (y, yp) = (components(y), components(yp));
        let columns = slice::from_raw_parts_mut(SUNDenseMatrix_Data(matrix), y.len() * y.len());
        let mut dense = Dense { columns, size: y.len() };
        guard::<Y>(user, time, |shared| shared.jacobian(time, y, yp, cj, &mut dense))
    }
}

unsafe extern "C" fn sparse_jacobian<Y: Dae>(
    time: f64,
    cj: f64,
    y: N_Vector,
    yp: N_Vector,
    _residual: N_Vector,
    matrix: SUNMatrix,
    user: *mut c_void,
    _: N_Vector,
    _: N_Vector,
    _: N_Vector,
) -> c_int {
    // SAFETY: as in `residual`; the matrix is the sparse one of `Solver::new`, whose arrays have as
    // many members as it says, and one pointer more than columns.
    unsafe {
        let (y, yp) = (components(y), components(yp));
        guard::<Y>(user, time, |shared| {
            let mut sparse = std::mem::take(&mut shared.sparse);
            sparse.clear();
            let written = shared.jacobian(time, y, yp, cj, &mut sparse);
            let entries = sparse.values.len();
            let more = entries as sunindextype > SUNSparseMatrix_NNZ(matrix);
            if more && SUNSparseMatrix_Reallocate(matrix, entries as sunindextype) != 0 {
                return Err(Fault::Fatal("there is no memory for the Newton matrix".into()));
            }
            let index = |place: &usize| *place as sunindextype;
            let fill = |to: *mut sunindextype, from: &[usize]| {
                let to = slice::from_raw_parts_mut(to, from.len());
                to.iter_mut().zip(from).for_each(|(to, from)| *to = index(from));
            };
            slice::from_raw_parts_mut(SUNSparseMatrix_Data(matrix), entries)
                .copy_from_slice(&sparse.values);
            fill(SUNSparseMatrix_IndexValues(matrix), &sparse.rows);
            fill(SUNSparseMatrix_IndexPointers(matrix), &sparse.begins);
            shared.sparse = sparse;
            written
        })
    }
}

unsafe extern "C" fn weigh<Y: Dae>(y: N_Vector, weights: N_Vector, user: *mut c_void) -> c_int {
    // SAFETY: IDA hands back `user` and two distinct vectors; the time is not known here, and not
    // needed, for the weights are not the system's.
    unsafe {
        let (y, weights) = (components(y), components_mut(weights));
        guard::<Y>(user, f64::NAN, |shared| {
            shared.weights.fill(y, weights);
            Ok(())
        })
    }
}

/// Keeps IDA's words, which would else go to stderr; its warnings are not kept.
unsafe extern "C" fn handle_error<Y: Dae>(
    code: c_int,
    _module: *const c_char,
    _function: *const c_char,
    message: *mut c_char,
    user: *mut c_void,
) {
    if code >= 0 || message.is_null() {
        return;
    }
    // SAFETY: IDA hands back `user` and a text that ends in a zero; no callback is running.
    unsafe {
        let words = CStr::from_ptr(message).to_string_lossy();
        guard::<Y>(user, f64::NAN, |shared| {
            shared.words = words.trim().to_owned();
            Ok(())
        });
    }
}
