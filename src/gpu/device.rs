//! Opening a device, and the one enum that decides which form of a pass runs on it.

use super::buffers::Staging;
use super::kernel::Compiled;
use std::sync::{Arc, OnceLock};

/// Which form of a pass suits the device. Decided once, by the kind of adapter, never by a timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tier {
    /// A software Vulkan (lavapipe, SwiftShader): barriers and passes are dear, serial loops cheap.
    Cpu,
    /// A graphics processor.
    Gpu,
}

/// What the user asked for on the command line.
#[derive(Clone, Debug, Default)]
pub struct DeviceRequest {
    /// Take only adapters whose name, or address on the PCI bus, contains this, case folded.
    pub contains: Option<String>,
    /// Take a software adapter even where there is a GPU.
    pub cpu: bool,
}

/// Why there is no device, or why it stopped.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// Nothing that speaks Vulkan, Metal or DirectX 12 answered.
    #[error(
        "no usable graphics adapter: {found}\n  looked for {wanted}\n  a GPU needs its driver and the Vulkan loader; without a GPU install lavapipe: \
         sudo apt install libvulkan1 mesa-vulkan-drivers (then `phystalk doctor`)"
    )]
    NoAdapter {
        /// What was found instead.
        found: String,
        /// What was asked for.
        wanted: String,
    },
    /// The adapter refused a device.
    #[error("the adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// An allocation would pass the adapter's limit.
    #[error(
        "{what} needs {needed_bytes} bytes in one buffer, and {device} allows {allowed_bytes}; use fewer Gaussians or a smaller solver.cells_across"
    )]
    TooLarge {
        /// What the buffer was for.
        what: String,
        /// How much it needs.
        needed_bytes: u64,
        /// How much the adapter allows.
        allowed_bytes: u64,
        /// The adapter's name.
        device: String,
    },
    /// The device has no memory left.
    #[error("the device {device} has no memory left: use fewer Gaussians, a smaller picture or a smaller solver.cells_across ({reason})")]
    NoMemory {
        /// The adapter's name.
        device: String,
        /// What the driver said.
        reason: String,
    },
    /// The device was lost, or a result could not be read back.
    #[error("the device {device} stopped answering: {reason}")]
    Lost {
        /// The adapter's name.
        device: String,
        /// What the driver said.
        reason: String,
    },
}

/// An open device. Cheap to clone; every clone is the same device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The wgpu device.
    pub device: wgpu::Device,
    /// Its only queue.
    pub queue: wgpu::Queue,
    /// Name, driver, backend and kind of the adapter.
    pub info: wgpu::AdapterInfo,
    /// Which form of each pass to run.
    pub tier: Tier,
    /// Lanes that execute together: the smallest and the largest subgroup the adapter may use.
    pub subgroup_lanes: (u32, u32),
    /// Whether timestamps may be written inside an encoder.
    pub can_time: bool,
    /// What was compiled on it.
    pub(super) compiled: Arc<Compiled>,
    /// What read-backs land in.
    pub(super) staging: Arc<Staging>,
    /// The first thing that the driver refused where no call could return it.
    pub(super) refused: Arc<OnceLock<wgpu::Error>>,
}

impl Gpu {
    /// Opens the best adapter that fits: a GPU where there is one, else a software adapter.
    pub fn open(request: &DeviceRequest) -> Result<Gpu, GpuError> {
        pollster::block_on(open(request))
    }

    /// What an open device can do.
    fn of(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Gpu {
        let info = adapter.get_info();
        let features = device.features();
        Gpu {
            tier: tier_of(&info),
            subgroup_lanes: (info.subgroup_min_size, info.subgroup_max_size),
            can_time: features.contains(TIMING),
            compiled: Arc::default(),
            staging: Arc::default(),
            refused: hear_refusals(&device),
            device,
            queue,
            info,
        }
    }

    /// The adapter's name as shown to users and kept in `metrics.json`.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// Bytes that everything on the device takes now, and that were set aside for it in blocks; none where the backend
    /// does not tell.
    pub fn memory(&self) -> Option<(u64, u64)> {
        self.device.generate_allocator_report().map(|report| (report.total_allocated_bytes, report.total_reserved_bytes))
    }

    /// A device lost in the middle of work, in the user's words.
    pub fn lost(&self, reason: impl std::fmt::Display) -> GpuError {
        GpuError::Lost { device: self.info.name.clone(), reason: reason.to_string() }
    }

    /// Whether another one is the same device.
    pub fn is(&self, other: &Gpu) -> bool {
        Arc::ptr_eq(&self.refused, &other.refused)
    }

    /// An error where the driver refused something since the device was opened: what was to be made then is not there.
    pub fn sound(&self) -> Result<(), GpuError> {
        match self.refused.get() {
            None => Ok(()),
            Some(wgpu::Error::OutOfMemory { source }) => Err(GpuError::NoMemory { device: self.info.name.clone(), reason: source.to_string() }),
            Some(error) => Err(self.lost(error)),
        }
    }

    /// One device for all tests of a binary: opening one a test would cost more than the tests do.
    ///
    /// Returns an error where the machine has no Vulkan at all, which fails the test: none is skipped.
    pub fn shared_for_tests() -> Result<Gpu, String> {
        static SHARED: OnceLock<Result<Gpu, String>> = OnceLock::new();
        SHARED.get_or_init(|| Gpu::open(&DeviceRequest::default()).map_err(|e| e.to_string())).clone()
    }
}

/// Keeps the first error of a device that no call returns, where it would else end the process.
fn hear_refusals(device: &wgpu::Device) -> Arc<OnceLock<wgpu::Error>> {
    let refused = Arc::new(OnceLock::new());
    let heard = refused.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        tracing::error!(%error, "the driver refused something");
        // Only the first one tells the cause.
        let _ = heard.set(error);
    }));
    refused
}

/// Features that timing needs; asked for where the adapter has them.
const TIMING: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);

/// Features without which no pass of ours runs.
const REQUIRED: wgpu::Features = wgpu::Features::SUBGROUP.union(wgpu::Features::IMMEDIATES);

/// Memory is set aside in blocks of so many bytes, larger ones as more is needed; the usual 128 MB and more would be
/// most of what a small scene takes.
const BLOCK_BYTES: std::ops::Range<u64> = 32 << 20..128 << 20;

/// Every way to a device that our passes can run on.
const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);

fn instance(backends: wgpu::Backends) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // Indirect counts come from our own kernels; checking each one costs more than the dispatch.
    descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    wgpu::Instance::new(descriptor)
}

fn tier_of(info: &wgpu::AdapterInfo) -> Tier {
    match info.device_type {
        wgpu::DeviceType::Cpu => Tier::Cpu,
        _ => Tier::Gpu,
    }
}

/// Every adapter of this machine, for `doctor`.
pub fn list_adapters() -> Vec<wgpu::AdapterInfo> {
    let instance = instance(BACKENDS);
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all())).iter().map(wgpu::Adapter::get_info).collect()
}

/// Discrete before integrated before virtual before software.
fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// Whether an adapter is what was asked for, and able.
fn fits(adapter: &wgpu::Adapter, request: &DeviceRequest) -> bool {
    let info = adapter.get_info();
    is_called(&info, request) && (!request.cpu || info.device_type == wgpu::DeviceType::Cpu) && adapter.features().contains(REQUIRED)
}

/// By its name, or by its place, which tells equal ones apart.
fn is_called(info: &wgpu::AdapterInfo, request: &DeviceRequest) -> bool {
    let names = [&info.name, &info.device_pci_bus_id].map(|name| name.to_lowercase());
    request.contains.as_ref().is_none_or(|want| names.iter().any(|name| name.contains(&want.to_lowercase())))
}

/// The adapters behind some backends, the best first.
async fn adapters_of(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let mut adapters = instance(backends).enumerate_adapters(backends).await;
    adapters.sort_by_key(|a| rank(a.get_info().device_type));
    adapters
}

async fn open(request: &DeviceRequest) -> Result<Gpu, GpuError> {
    // Each backend takes its time to answer: the others are asked only where Vulkan has no GPU that fits.
    let mut adapters = adapters_of(wgpu::Backends::VULKAN).await;
    if !adapters.iter().any(|a| fits(a, request) && (request.cpu || tier_of(&a.get_info()) == Tier::Gpu)) {
        adapters.extend(adapters_of(BACKENDS.difference(wgpu::Backends::VULKAN)).await);
        adapters.sort_by_key(|a| rank(a.get_info().device_type));
    }
    tracing::debug!(adapters = adapters.len(), "adapters listed");
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    let Some(adapter) = adapters.iter().find(|a| fits(a, request)) else {
        let wanted = match (&request.contains, request.cpu) {
            (Some(name), _) => format!("a device whose name or PCI address contains \"{name}\""),
            (None, true) => "a software adapter (--cpu)".to_owned(),
            (None, false) => "any adapter with subgroups and immediates".to_owned(),
        };
        let found = if names.is_empty() { "none was found".to_owned() } else { format!("found {}", names.join(", ")) };
        return Err(GpuError::NoAdapter { found, wanted });
    };
    let info = adapter.get_info();
    let optional = TIMING | wgpu::Features::PIPELINE_CACHE;
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("phystalk"),
        required_features: REQUIRED | (adapter.features() & optional),
        required_limits: adapter.limits(),
        memory_hints: wgpu::MemoryHints::Manual { suballocated_device_memory_block_size: BLOCK_BYTES },
        ..Default::default()
    };
    let (device, queue) =
        adapter.request_device(&descriptor).await.map_err(|e| GpuError::NoDevice { adapter: info.name.clone(), reason: e.to_string() })?;
    tracing::debug!(name = info.name, "device opened");
    Ok(Gpu::of(adapter, device, queue))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Readback;

    #[test]
    fn what_the_driver_refuses_comes_with_the_next_read_back() {
        // A device of its own: the shared one stays sound.
        let gpu = Gpu::open(&DeviceRequest::default()).unwrap();
        let good = gpu.storage::<u32>("good", 4).unwrap();
        assert!(gpu.sound().is_ok() && gpu.read::<u32>(&good, 4).is_ok());
        let size = gpu.device.limits().max_buffer_size + 4;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let refused = gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some("too large"), size, usage, mapped_at_creation: false });
        let error = Readback::start(&gpu, &[(&refused, 16)]).arrive(&gpu).unwrap_err();
        assert!(matches!(error, GpuError::Lost { .. } | GpuError::NoMemory { .. }), "{error}");
    }

    #[test]
    fn equal_devices_are_told_apart_by_their_place() {
        let info = wgpu::AdapterInfo { device_pci_bus_id: "0000:1a:00.0".to_owned(), ..Gpu::shared_for_tests().unwrap().info.clone() };
        let called = |want: &str| is_called(&info, &DeviceRequest { contains: Some(want.to_owned()), cpu: false });
        assert!(called("0000:1A:00") && called(&info.name.to_uppercase()) && !called("0000:1b:00"));
    }
}
