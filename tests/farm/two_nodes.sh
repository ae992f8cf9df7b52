# Sourced: a Slurm of two nodes on this host, on loopback, below the folder $slurm; needs root, slurmctld and munged.
# Nothing of it is installed or left behind: stop_slurm ends what start_slurm began.

start_slurm() {
    local host
    host=$(hostname -s)
    mkdir -p "$slurm"/{state,n1,n2}
    chmod 755 "$slurm"
    head -c 1024 /dev/urandom >"$slurm/munge.key"
    chmod 600 "$slurm/munge.key"
    cat >"$slurm/slurm.conf" <<CONF
ClusterName=rt
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=27817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.sock
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/%n
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/%n.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobRequeue=1
RequeueExit=75
ReturnToService=2
SlurmdTimeout=30
MaxArraySize=1001
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=28001 CPUs=2 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=28002 CPUs=2 State=UNKNOWN
PartitionName=render Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF=$slurm/slurm.conf
    munged --force --key-file="$slurm/munge.key" --socket="$slurm/munge.sock" --pid-file="$slurm/munged.pid" \
        --log-file="$slurm/munged.log" --seed-file="$slurm/munged.seed"
    slurmctld
    slurmd -N n1
    slurmd -N n2
    local i
    for ((i = 0; i < 300; ++i)); do
        [[ $(sinfo -h -t idle -o %D 2>/dev/null) == 2 ]] && return 0
        sleep 0.1
    done
    return 1
}

stop_slurm() {
    local name
    scancel --quiet --user root 2>/dev/null || true
    for name in n1 n2 slurmctld munged; do
        [[ -s $slurm/$name.pid ]] && kill "$(<"$slurm/$name.pid")" 2>/dev/null
    done
    sleep 1
    for name in n1 n2 slurmctld munged; do
        [[ -s $slurm/$name.pid ]] && kill -9 "$(<"$slurm/$name.pid")" 2>/dev/null
    done
    return 0
}
