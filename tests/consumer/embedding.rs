// SPDX-License-Identifier: MIT
// gnomon inside a Rust program that uses OpenCL itself, by raw handles: the program's own context, queue and buffers.
use std::ffi::CStr;
use std::os::raw::{c_char, c_float, c_int, c_void};
use std::ptr::{null, null_mut};

type Handle = *mut c_void;

#[repr(C)]
#[derive(Clone, Copy)]
struct Light {
    xyzw: [c_float; 4],
}

#[link(name = "gnomon")]
extern "C" {
    fn gnomon_last_error() -> *const c_char;
    fn gnomon_device_wrap(context: Handle, queue: Handle, options: *const c_void, out: *mut Handle) -> c_int;
    fn gnomon_triangles_wrap(device: Handle, vertices: Handle, count: usize, first_float: usize, out: *mut Handle)
        -> c_int;
    fn gnomon_points_wrap(device: Handle, positions: Handle, layout: *const c_void, count: usize, receivers: Handle,
                          out: *mut Handle) -> c_int;
    fn gnomon_visibility_wrap(device: Handle, buffer: Handle, count: usize, first_float: usize, out: *mut Handle)
        -> c_int;
    fn gnomon_technique_create(device: Handle, name: *const c_char, out: *mut Handle) -> c_int;
    fn gnomon_light_directional(direction: *const c_float, out: *mut Light) -> c_int;
    fn gnomon_technique_run(technique: Handle, triangles: Handle, points: Handle, light: Light, visibility: Handle,
                            options: *const c_void, event: *mut Handle, statistics: *mut Handle) -> c_int;
    fn gnomon_technique_destroy(technique: Handle);
    fn gnomon_visibility_destroy(visibility: Handle);
    fn gnomon_points_destroy(points: Handle);
    fn gnomon_triangles_destroy(triangles: Handle);
    fn gnomon_device_destroy(device: Handle);
}

#[link(name = "OpenCL")]
extern "C" {
    fn clGetPlatformIDs(count: u32, platforms: *mut Handle, found: *mut u32) -> c_int;
    fn clGetDeviceIDs(platform: Handle, kind: u64, count: u32, devices: *mut Handle, found: *mut u32) -> c_int;
    fn clCreateContext(properties: *const isize, count: u32, devices: *const Handle, notify: *const c_void,
                       user: Handle, code: *mut c_int) -> Handle;
    fn clCreateCommandQueue(context: Handle, device: Handle, properties: u64, code: *mut c_int) -> Handle;
    fn clCreateBuffer(context: Handle, flags: u64, bytes: usize, host: *const c_void, code: *mut c_int) -> Handle;
    fn clEnqueueReadBuffer(queue: Handle, buffer: Handle, blocking: u32, offset: usize, bytes: usize, to: *mut c_float,
                           waits: u32, wait_list: *const Handle, event: *mut Handle) -> c_int;
    fn clReleaseEvent(event: Handle) -> c_int;
    fn clReleaseMemObject(buffer: Handle) -> c_int;
    fn clReleaseCommandQueue(queue: Handle) -> c_int;
    fn clReleaseContext(context: Handle) -> c_int;
}

const EVERY_DEVICE: u64 = 0xFFFF_FFFF;
const READ_WRITE: u64 = 1;
const COPY_HOST: u64 = 1 << 5;

fn done(status: c_int) -> Result<(), String> {
    if status == 0 {
        return Ok(());
    }
    Err(unsafe { CStr::from_ptr(gnomon_last_error()) }.to_string_lossy().into_owned())
}

fn made(call: impl FnOnce(*mut Handle) -> c_int) -> Result<Handle, String> {
    let mut out = null_mut();
    done(call(&mut out)).map(|()| out)
}

fn required(code: c_int) -> Result<(), String> {
    if code == 0 { Ok(()) } else { Err(format!("OpenCL failed ({code})")) }
}

unsafe fn buffer_of(context: Handle, numbers: &[c_float]) -> Result<Handle, String> {
    let mut code = 0;
    let bytes = std::mem::size_of_val(numbers);
    let buffer = clCreateBuffer(context, READ_WRITE | COPY_HOST, bytes, numbers.as_ptr().cast(), &mut code);
    required(code).map(|()| buffer)
}

/// The event completes when `visibility`, a buffer of `count` floats, has its values.
unsafe fn cast_shadows(context: Handle, queue: Handle, vertices: Handle, triangle_count: usize, positions: Handle,
                       count: usize, visibility: Handle) -> Result<Handle, String> {
    let mut sun = Light { xyzw: [0.0; 4] };
    // README begins
    let device = made(|out| gnomon_device_wrap(context, queue, null(), out))?;
    let triangles = made(|out| gnomon_triangles_wrap(device, vertices, triangle_count, 0, out))?;
    let points = made(|out| gnomon_points_wrap(device, positions, null(), count, null_mut(), out))?;
    let result = made(|out| gnomon_visibility_wrap(device, visibility, count, 0, out))?;
    let technique = made(|out| gnomon_technique_create(device, b"frustum-traced\0".as_ptr().cast(), out))?;
    done(gnomon_light_directional([0.0, -1.0, 0.0].as_ptr(), &mut sun))?;
    let event = made(|out| {
        gnomon_technique_run(technique, triangles, points, sun, result, null(), out, null_mut())
    })?;
    // README ends
    gnomon_technique_destroy(technique);
    gnomon_visibility_destroy(result);
    gnomon_points_destroy(points);
    gnomon_triangles_destroy(triangles);
    gnomon_device_destroy(device);
    Ok(event)
}

fn main() -> Result<(), String> {
    let roof: [c_float; 18] = [-1., 2., -1., 1., 2., -1., 1., 2., 1., -1., 2., -1., 1., 2., 1., -1., 2., 1.];
    let ground: [c_float; 9] = [0., 0., 0., 1., 0., 0., 1.001, 0., 0.]; // under its middle, under its edge, beside it
    let mut lit = [-1.0; 3];
    unsafe {
        let (mut platform, mut device, mut code) = (null_mut(), null_mut(), 0);
        required(clGetPlatformIDs(1, &mut platform, null_mut()))?;
        required(clGetDeviceIDs(platform, EVERY_DEVICE, 1, &mut device, null_mut()))?;
        let context = clCreateContext(null(), 1, &device, null(), null_mut(), &mut code);
        required(code)?;
        let queue = clCreateCommandQueue(context, device, 0, &mut code);
        required(code)?;
        let (vertices, positions) = (buffer_of(context, &roof)?, buffer_of(context, &ground)?);
        let visibility = buffer_of(context, &lit)?;
        let event = cast_shadows(context, queue, vertices, 2, positions, 3, visibility)?;
        required(clEnqueueReadBuffer(queue, visibility, 1, 0, 12, lit.as_mut_ptr(), 1, &event, null_mut()))?;
        required(clReleaseEvent(event))?;
        for buffer in [vertices, positions, visibility] {
            required(clReleaseMemObject(buffer))?;
        }
        required(clReleaseCommandQueue(queue))?;
        required(clReleaseContext(context))?;
    }
    println!("{}", lit.map(|value| format!("{value:.2}")).join(" "));
    if lit == [0.0, 0.0, 1.0] { Ok(()) } else { Err("an edge blocks, it is part of the roof".into()) }
}
